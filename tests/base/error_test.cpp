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

TEST(Problem, ShowsTheBeginningOfWhatWasFoundInOneLine) {
  EXPECT_EQ((Problem{.what = "no unit", .found = "a\n\x1b[2Jb"}.message()), "no unit: found a??[2Jb");
  const std::string most(300, 'x');
  EXPECT_EQ((Problem{.what = "no unit", .found = most}.message()), "no unit: found " + most);
  EXPECT_EQ((Problem{.what = "no unit", .found = std::string(100000, 'x')}.message()),
            "no unit: found " + most + "... (100000 bytes)");
  // 299 letters and a letter of two bytes: it is left out whole.
  EXPECT_EQ((Problem{.what = "no unit", .found = std::string(299, 'x') + "\u00b0C"}.message()),
            "no unit: found " + std::string(299, 'x') + "... (302 bytes)");
}

TEST(Error, CarriesTheExitStatusOfItsKind) {
  EXPECT_EQ(InputError("x").status(), ExitStatus::input);
  EXPECT_EQ(UsageError("x").status(), ExitStatus::usage);
  EXPECT_EQ(ValidityError("x").status(), ExitStatus::validity);
  EXPECT_EQ(NumericalError("x").status(), ExitStatus::numerical);
  EXPECT_EQ(NotBuiltError("x").status(), ExitStatus::not_built);
}

TEST(Error, KeepsItsPartsWhenItIsCopied) {
  const InputError original(
      {.what = "wrong unit", .where = "a.h5", .found = "'kPa'", .advice = "convert it"});
  const Error copy = original;

  EXPECT_EQ(copy.problem().what, "wrong unit");
  EXPECT_EQ(copy.problem().found, "'kPa'");
  EXPECT_EQ(copy.problem().message(), copy.what());
  EXPECT_EQ(InputError("a sentence").problem().what, "a sentence");
}

TEST(Check, ThrowsOnlyForAFalseCondition) {
  EXPECT_NO_THROW(check(true, "fine"));
  EXPECT_THROW(check(false, "broken"), std::logic_error);
}

}  // namespace
}  // namespace elrom
