#include "elrom/field/case_json.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::field {
namespace {

const InputSchema one_input({{.name = "primary_air", .unit = "kg/s", .display_unit = "t/h"}});

TEST(CaseJson, ReadsOneCaseByTheRulesOfCaseFiles) {
  const auto one = parse_case(R"({"case": "a", "load [%]": 64, "inputs": {"primary_air [t/h]": 360}})",
                              "request", one_input);

  EXPECT_EQ(one.name, "a");
  EXPECT_DOUBLE_EQ(one.load, 0.64);
  EXPECT_DOUBLE_EQ(one.values.at(0), 100);
  EXPECT_TRUE(std::isnan(parse_case(R"({"case": "a", "inputs": {"primary_air": 1}})", "x", one_input).load));
}

TEST(CaseJson, SaysWhereTheMistakeIs) {
  EXPECT_ERROR(InputError, "not JSON", parse_case("{", "request", one_input));
  EXPECT_ERROR(InputError, "missing boundary condition 'primary_air [t/h]' in request, case 'a'",
               parse_case(R"({"case": "a", "inputs": {}})", "request", one_input));
  EXPECT_ERROR(InputError, "missing text 'case'", parse_case(R"({"inputs": {}})", "request", one_input));
}

// JSON has no order of names: theirs is that of the alphabet.
TEST(CaseJson, ACaseDeclaresItsOwnSchema) {
  const auto declared =
      declared_schema(R"({"case": "a", "inputs": {"steam [t/h]": 1, "share": 0.5}})", "request");

  ASSERT_EQ(declared.size(), 2U);
  EXPECT_EQ(declared[0], (InputInfo{.name = "share", .unit = "1", .display_unit = "1"}));
  EXPECT_EQ(declared[1], (InputInfo{.name = "steam", .unit = "kg/s", .display_unit = "t/h"}));
  EXPECT_ERROR(
      InputError, "'steam' appears twice",
      declared_schema(R"({"case": "a", "inputs": {"steam [t/h]": 1, "steam [kg/s]": 1}})", "request"));
}

}  // namespace
}  // namespace elrom::field
