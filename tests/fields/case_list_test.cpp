#include "case_list.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::fields {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class CaseListTest : public ::testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const field::InputSchema schema_{{{"air", "kg/s", "t/h"}, {"fuel", "kg/s", "kg/s"}}};
  Arguments arguments_;

  void SetUp() override {
    test::write_bytes(folder_ / "cases.csv",
                      "case,load,air [kg/s],fuel [kg/s]\nload_1,0.5,10,1\nload_2,0.6,20,2\nrep_1,0.5,10,1\n");
    arguments_.cases = folder_ / "cases.csv";
  }
  [[nodiscard]] std::string refusal() const {
    try {
      (void)case_list(arguments_, schema_);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(CaseListTest, PatternsChooseAndSettingsChange) {
  arguments_.case_patterns = {"load_*"};
  arguments_.settings = {"air=36", "fuel=3600 kg/h"};

  const auto cases = case_list(arguments_, schema_);

  ASSERT_EQ(cases.size(), 2U);
  EXPECT_EQ(cases[1].name, "load_2");
  EXPECT_THAT(cases[1].values, ElementsAre(::testing::DoubleEq(10), ::testing::DoubleEq(1)));
}

TEST_F(CaseListTest, SettingsAloneMustBeComplete) {
  arguments_.cases.clear();
  arguments_.settings = {"air=36"};
  EXPECT_THAT(refusal(), HasSubstr("1 inputs are not given: fuel"));

  arguments_.settings.emplace_back("fuel=2");
  EXPECT_THAT(case_list(arguments_, schema_)[0].values, ElementsAre(::testing::DoubleEq(10), 2));
}

TEST_F(CaseListTest, UnknownCasesAndInputsNameTheNearest) {
  arguments_.case_patterns = {"load_3"};
  EXPECT_THAT(refusal(), HasSubstr("did you mean 'load_1'?"));

  arguments_.case_patterns.clear();
  arguments_.settings = {"fule=3"};
  EXPECT_THAT(refusal(), HasSubstr("fuel"));
}

TEST_F(CaseListTest, AnAbsurdCaseNameNeverBecomesAPath) {
  arguments_.cases.clear();
  arguments_.settings = {"air=36", "fuel=2"};

  for (const char* name : {"../../evil", "", ".hidden", "a/b"}) {
    arguments_.name = name;
    EXPECT_THAT(refusal(), HasSubstr("case name cannot be a file's name")) << name;
  }
}

TEST_F(CaseListTest, StandardOutputTakesOneCase) {
  arguments_.output = "-";

  EXPECT_THAT(refusal(), HasSubstr("found 3 cases"));
}

}  // namespace
}  // namespace elrom::fields
