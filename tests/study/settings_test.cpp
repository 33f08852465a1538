#include "elrom/study/settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"

namespace elrom::study {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class SettingsFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    base::write_text(path_, text);
    return path_;
  }
  void TearDown() override { std::filesystem::remove(path_); }
  std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
      (void)read_settings(write(text), overrides);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("settings_" + std::to_string(::getpid()) + ".toml");
};

TEST_F(SettingsFile, MissingFileGivesTheStandardLevel) {
  const auto settings = read_settings("no/such/study.toml");

  EXPECT_EQ(settings.effort, "standard");
  EXPECT_EQ(settings.screen.builds, 5);
  EXPECT_EQ(settings.split.by, "case");
}

TEST_F(SettingsFile, EffortIsAppliedBeforeTheOtherKeysOfTheFile) {
  const auto settings = read_settings(write("effort = \"quick\"\n[screen]\nbuilds = 4\n"));

  EXPECT_EQ(settings.screen.builds, 4);
  EXPECT_EQ(settings.search.trials, 4);
}

TEST_F(SettingsFile, CommandLineWinsOverTheFile) {
  const auto settings = read_settings(write("method = \"linear\"\n[search]\ntrials = 7\n"),
                                      {"search.trials=9", "method=nearest", "bands.edges=[0.1, 0.4]"});

  EXPECT_EQ(settings.search.trials, 9);
  EXPECT_EQ(settings.method, "nearest");
  EXPECT_EQ(settings.bands.edges, (std::vector<double>{0.1, 0.4}));
}

TEST_F(SettingsFile, UnknownKeyIsRefusedWithLineAndNearestKey) {
  EXPECT_THAT(refusal("seed = 3\n[screen]\nbuild = 4\n"),
              AllOf(HasSubstr("toml:3"), HasSubstr("screen.builds")));
}

TEST_F(SettingsFile, UnknownSectionIsRefused) {
  EXPECT_THAT(refusal("[serch]\ntrials = 4\n"), HasSubstr("serch"));
}

TEST_F(SettingsFile, KeyInTheWrongSectionIsPointedToItsOwn) {
  EXPECT_THAT(refusal("trials = 4\n"), HasSubstr("search.trials"));
}

TEST_F(SettingsFile, ValueOfAnotherTypeOrRangeIsRefused) {
  EXPECT_THAT(refusal("[screen]\nbuilds = \"five\"\n"),
              AllOf(HasSubstr("screen.builds"), HasSubstr("toml:2")));
  EXPECT_THAT(refusal("[screen]\nbuilds = 0\n"), HasSubstr("whole number"));
  EXPECT_THAT(refusal("[split]\nfractions = [0.9, 0.2, 0.1]\n"), HasSubstr("add up to 1"));
  EXPECT_THAT(refusal("[bands]\nedges = [0.3, 0.2]\n"), HasSubstr("ascending"));
  EXPECT_THAT(refusal("method = \"lineer\"\n"), HasSubstr("linear"));
  EXPECT_THAT(refusal("", {"effort=fast"}), HasSubstr("quick"));
}

TEST_F(SettingsFile, BrokenTomlSaysTheLine) {
  EXPECT_THAT(refusal("seed = 1\nmethod = \n"), HasSubstr("toml:2"));
}

TEST_F(SettingsFile, ResolvedTextReadsBackToItself) {
  auto settings =
      read_settings(write("effort = \"quick\"\n[[symmetry.mirror]]\nname = \"m\"\naxis = \"x\"\n"
                          "swap = [[\"a_*\", \"b_*\"]]\ncomplement = [\"q\"]\n"
                          "[networks]\ntransform = { pressure = \"asinh\" }\n"));
  const auto text = to_toml(settings);

  const auto again = read_settings(write(text));

  EXPECT_EQ(to_toml(again), text);
  ASSERT_EQ(again.symmetry.mirrors.size(), 1u);
  EXPECT_EQ(again.symmetry.mirrors[0].swap[0].second, "b_*");
  EXPECT_EQ(again.networks.transform.at("pressure"), "asinh");
}

}  // namespace
}  // namespace elrom::study
