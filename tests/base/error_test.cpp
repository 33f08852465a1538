#include "elrom/base/error.hpp"

#include <gtest/gtest.h>

namespace elrom {
namespace {

TEST(Problem, SaysWhatWhereFoundExpectedAndAdviceInOneLine) {
  const Problem problem{.what = "wrong unit",
                        .where = "case.h5:/fields/pressure",
                        .found = "'kPa'",
                        .expected = "'Pa'",
                        .advice = "convert it"};

  EXPECT_EQ(problem.message(),
            "wrong unit in case.h5:/fields/pressure: found 'kPa', expected 'Pa'; convert it");
}

TEST(Problem, LeavesOutWhatIsEmpty) {
  EXPECT_EQ((Problem{.what = "no cases"}.message()), "no cases");
  EXPECT_EQ((Problem{.what = "no cases", .expected = "at least 2"}.message()),
            "no cases: expected at least 2");
}

TEST(Error, CarriesTheExitStatusOfItsKind) {
  EXPECT_EQ(InputError("x").status(), ExitStatus::input);
  EXPECT_EQ(UsageError("x").status(), ExitStatus::usage);
  EXPECT_EQ(ValidityError("x").status(), ExitStatus::validity);
  EXPECT_EQ(NumericalError("x").status(), ExitStatus::numerical);
  EXPECT_EQ(NotBuiltError("x").status(), ExitStatus::not_built);
}

TEST(Check, ThrowsOnlyForAFalseCondition) {
  EXPECT_NO_THROW(check(true, "fine"));
  EXPECT_THROW(check(false, "broken"), std::logic_error);
}

}  // namespace
}  // namespace elrom
