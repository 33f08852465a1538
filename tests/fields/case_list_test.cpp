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

  const auto cases = case_list(arguments_, schema_).cases;

  ASSERT_EQ(cases.size(), 2U);
  EXPECT_EQ(cases[1].name, "load_2+air=36+fuel=3600kg_h") << "36 in the unit that numbers alone are in";
  EXPECT_THAT(cases[1].values, ElementsAre(::testing::DoubleEq(10), ::testing::DoubleEq(1)));
}

TEST_F(CaseListTest, SettingsAloneMustBeComplete) {
  arguments_.cases.clear();
  arguments_.settings = {"air=36"};
  EXPECT_THAT(refusal(), HasSubstr("1 input is not given: fuel"));

  arguments_.settings.emplace_back("fuel=2");
  EXPECT_THAT(case_list(arguments_, schema_).cases[0].values, ElementsAre(::testing::DoubleEq(10), 2));
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

  for (const char* name : {"../../evil", ".hidden", "a/b"}) {
    arguments_.name = name;
    EXPECT_THAT(refusal(), HasSubstr("case name cannot be a file's name")) << name;
  }
}

TEST_F(CaseListTest, StandardOutputTakesSeveralCasesAsCsvAlone) {
  arguments_.output = "-";
  arguments_.formats = {Format::ip};
  EXPECT_THAT(refusal(), HasSubstr("found 3 cases"));

  arguments_.formats = {Format::csv};
  EXPECT_EQ(case_list(arguments_, schema_).cases.size(), 3U);
}

TEST_F(CaseListTest, ANameIsForTheChangedCase) {
  arguments_.case_patterns = {"load_1"};
  arguments_.settings = {"air=37t/h"};
  arguments_.name = "more_air";
  EXPECT_EQ(case_list(arguments_, schema_).cases[0].name, "more_air");

  arguments_.case_patterns = {"load_*"};
  EXPECT_EQ(case_list(arguments_, schema_).cases[1].name, "load_2+more_air");
}

std::vector<std::string> names_of(const CaseList& list) {
  std::vector<std::string> names;
  for (const auto& one : list.cases) names.push_back(one.name);
  return names;
}

TEST_F(CaseListTest, ASweepFollowsItsBaseOneInputAtATime) {
  arguments_.case_patterns = {"load_1"};
  arguments_.sweeps = {"air=10:11:0.5 kg/s", "fuel=2:1:-1"};

  const auto list = case_list(arguments_, schema_);

  EXPECT_THAT(names_of(list), ElementsAre("load_1", "load_1+air=10kg_s", "load_1+air=10.5kg_s",
                                          "load_1+air=11kg_s", "load_1+fuel=2", "load_1+fuel=1"));
  EXPECT_EQ(list.swept[0].unit->symbol, "kg/s");
  EXPECT_THAT(list.cases[2].values, ElementsAre(::testing::DoubleEq(10.5), 1));
  EXPECT_THAT(list.cases[4].values, ElementsAre(10, 2));
  EXPECT_EQ(list.origins[4].base, 0U);
  EXPECT_THAT(list.origins[4].changed, ElementsAre(1));
}

TEST_F(CaseListTest, AGridIsEveryCombination) {
  arguments_.case_patterns = {"load_*"};
  arguments_.sweeps = {"air=36:72:36", "fuel=1:3:1"};
  arguments_.grid = true;

  const auto list = case_list(arguments_, schema_);

  ASSERT_EQ(list.cases.size(), 2 * (1 + 2 * 3));
  EXPECT_EQ(list.cases[7].name, "load_2");
  EXPECT_EQ(list.cases[13].name, "load_2+air=72+fuel=3");
  EXPECT_EQ(list.origins[13].base, 7U);
}

TEST_F(CaseListTest, SweepsThatAreNoneAreRefusedWithWhatIsWrong) {
  const std::pair<const char*, const char*> mistakes[] = {
      {"air", "--sweep cannot be read"},
      {"air=1:2", "expected name=start:stop:step"},
      {"air=a:2:1", "--sweep cannot be read"},
      {"air=1:2:0", "--sweep has a step of 0: found 'air=1:2:0'"},
      {"air=225:150:5", "--sweep runs away from its end"},
      {"air=225:150:5", "a step of -5 leads from 225 to 150"},
      {"air=1:1e9:1", "--sweep has too many values"},
      {"air=1:2:1 kg", "wrong unit of 'air'"},
      {"load=0.5:0.7:0.1", "a load is a case's label, and no model goes by it; known are: air, fuel"}};
  for (const auto& [sweep, text] : mistakes) {
    arguments_.sweeps = {sweep};
    EXPECT_THAT(refusal(), HasSubstr(text)) << sweep;
  }
  arguments_.sweeps = {"air=1:2:1", "air=3:4:1"};
  EXPECT_THAT(refusal(), HasSubstr("'air' is swept twice"));
}

TEST_F(CaseListTest, AnInputIsSetOrSwept) {
  arguments_.case_patterns = {"load_1"};
  arguments_.settings = {"air=36"};
  arguments_.sweeps = {"air=30:40:5"};
  EXPECT_THAT(refusal(), HasSubstr("'air' is in --set and in --sweep: expected one of them"));

  arguments_.case_patterns.clear();
  arguments_.cases.clear();
  arguments_.settings.emplace_back("fuel=2");
  EXPECT_EQ(case_list(arguments_, schema_).cases.size(), 4U) << "where --set makes the base";
}

TEST_F(CaseListTest, ImpossibleInputsAreRefusedInTheUsersUnit) {
  arguments_.case_patterns = {"load_1"};
  for (const char* value : {"air=-1", "air=1e99", "fuel=-0.1kg/s"}) {
    arguments_.settings = {value};
    EXPECT_THAT(refusal(), HasSubstr("impossible ")) << value;
  }
  arguments_.settings = {"air=-36"};
  EXPECT_THAT(refusal(), HasSubstr("impossible air in case load_1+air=-36: found -36 t/h"));
}

}  // namespace
}  // namespace elrom::fields
