#include "elrom/cli/cli.hpp"

#include <gmock/gmock.h>

#include "elrom/base/comma_list.hpp"
#include "elrom/base/error.hpp"

namespace elrom::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A program with two commands, and what they read.
struct Program {
  App app{"Cooks.", "cook"};
  std::filesystem::path output;
  std::string heat = "low";
  std::vector<std::string> spices, guests;
  std::vector<std::filesystem::path> dishes;
  int minutes = 10;
  double salt = 0.5;
  std::optional<double> pepper;
  std::optional<std::uint64_t> lids;
  std::vector<std::string> tables;
  double weight = 0;
  bool quiet = false, open = false;
  std::string called;

  Program() {
    app.set_version_flag("--version", "1.2");
    app.require_subcommand(1);
    auto* boil = app.add_subcommand("boil", "Boils.");
    boil->add_option("--output", output, "Pot")->type_name("POT")->required();
    boil->add_option("--heat", heat, "How hot")->check(IsMember({"low", "high"}))->capture_default_str();
    base::comma_list(boil->add_option("--spices", spices, "With"));
    base::repeatable(boil->add_option("--guest", guests, "For whom"));
    boil->add_option("--minutes", minutes, "How long")->check(Range(1, 90));
    boil->add_option("--salt", salt, "g");
    boil->add_option("--pepper", pepper, "g");
    boil->add_flag("--quiet,-q", quiet, "No words");
    boil->add_option("DISH", dishes, "What")->required();
    auto* lid = boil->add_option("--lid", lids, "How many lids");
    boil->add_option("--weight", weight, "g, on the lid")->needs(lid);
    boil->add_flag("--open", open, "No lid")->excludes(lid);
    boil->callback([this] { called = "boil"; });
    auto* serve = app.add_subcommand("serve", "Serves.");
    serve->add_option("TABLE", tables, "Where")->expected(1);
    serve->callback([this] { called = "serve"; });
  }

  std::optional<int> parse(std::vector<const char*> words) {
    words.insert(words.begin(), "/usr/bin/cook");
    return app.parse(static_cast<int>(words.size()), words.data());
  }
};

std::string refused(const std::vector<const char*>& words) {
  try {
    (void)Program().parse(words);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "taken";
}

TEST(CommandLine, ValuesOfEveryTypeAreRead) {
  Program program;
  EXPECT_FALSE(program.parse({"boil", "--output", "pot", "--heat=high", "--spices", "salt,dill", "rice",
                              "--guest", "a", "--guest", "b", "--minutes", "12", "--salt", "-.5", "--pepper",
                              "2e-1", "-q", "peas"}));
  EXPECT_EQ(program.called, "boil");
  EXPECT_EQ(program.output, "pot");
  EXPECT_EQ(program.heat, "high");
  EXPECT_THAT(program.spices, ElementsAre("salt", "dill"));
  EXPECT_THAT(program.guests, ElementsAre("a", "b"));
  EXPECT_THAT(program.dishes, ElementsAre("rice", "peas"));
  EXPECT_EQ(program.minutes, 12);
  EXPECT_EQ(program.salt, -0.5);
  EXPECT_EQ(program.pepper, 0.2);
  EXPECT_TRUE(program.quiet);
}

TEST(CommandLine, SlipsNameTheNearest) {
  EXPECT_EQ(refused({"bail", "rice"}), "unknown command 'bail'; did you mean 'boil'?");
  EXPECT_EQ(refused({"boil", "--outptu", "pot", "rice"}),
            "cook boil has no option --outptu; did you mean --output?");
  EXPECT_EQ(refused({"boil", "--outptu=pot", "rice"}),
            "cook boil has no option --outptu; did you mean --output?");
  EXPECT_EQ(refused({"boil", "-output", "pot"}), "cook boil has no option -output; did you mean --output?");
  EXPECT_EQ(refused({"boil", "rice", "--nothing-near"}),
            "cook boil has no option --nothing-near; 'cook boil --help' lists what it takes");
  EXPECT_EQ(refused({"boil", "rice", "--output", "pot", "--heat", "hihg"}),
            "--heat: found 'hihg', expected one of low, high; did you mean high?");
}

TEST(CommandLine, ASlipIsToldBeforeWhatItLeavesMissing) {
  EXPECT_THAT(refused({"boil", "--outptu", "pot"}), HasSubstr("did you mean --output?"));
}

TEST(CommandLine, MissingAndTooMuchAreNamed) {
  EXPECT_EQ(refused({}), "no command given; known are: boil, serve");
  EXPECT_EQ(refused({"boil"}), "cook boil needs --output POT, DISH; 'cook boil --help' lists what it takes");
  EXPECT_EQ(refused({"boil", "--output", "--quiet", "rice"}), "--output has no value: expected --output POT");
  EXPECT_EQ(refused({"boil", "rice", "--output"}), "--output has no value: expected --output POT");
  EXPECT_EQ(refused({"serve", "left", "right"}),
            "cook serve does not take 'right'; 'cook serve --help' lists what it takes");
  EXPECT_EQ(refused({"boil", "--minutes", "3", "--minutes", "4"}),
            "--minutes is given twice: expected one value");
  EXPECT_EQ(refused({"--output", "pot", "boil"}),
            "option --output in front of the command; write it behind: cook boil --output");
}

TEST(CommandLine, ValuesThatCannotBeAreRefused) {
  EXPECT_EQ(refused({"boil", "rice", "--output", "pot", "--salt", "much"}),
            "--salt: found 'much', expected a number");
  EXPECT_EQ(refused({"boil", "rice", "--output", "pot", "--minutes", "7.5"}),
            "--minutes: found '7.5', expected a whole number");
  EXPECT_EQ(refused({"boil", "rice", "--output", "pot", "--minutes", "91"}),
            "--minutes: found '91', expected a number from 1 to 90");
}

TEST(CommandLine, OptionsThatDoNotGoTogetherAreRefused) {
  EXPECT_THAT(refused({"boil", "rice", "--output", "pot", "--weight", "3"}),
              HasSubstr("--weight requires --lid"));
  EXPECT_THAT(refused({"boil", "rice", "--output", "pot", "--lid", "1", "--open"}),
              HasSubstr("--lid excludes --open"));
  Program program;
  EXPECT_FALSE(program.parse({"boil", "rice", "--output", "pot", "--lid", "1", "--weight", "3"}));
  EXPECT_EQ(program.lids, 1u);
  EXPECT_EQ(program.weight, 3);
}

TEST(CommandLine, WordsBehindTwoDashesAreNoOptions) {
  Program program;
  EXPECT_FALSE(program.parse({"boil", "--output", "pot", "--", "--rice"}));
  EXPECT_THAT(program.dishes, ElementsAre("--rice"));
}

TEST(CommandLine, HelpWinsOverSlips) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(Program().parse({"boil", "--outptu", "--help"}), 0);
  const auto help = testing::internal::GetCapturedStdout();
  EXPECT_THAT(help, HasSubstr("--output POT REQUIRED"));
  EXPECT_THAT(help, HasSubstr("--heat TEXT:{low,high}=low"));
  EXPECT_THAT(help, HasSubstr("--spices TEXT ..."));
  testing::internal::CaptureStdout();
  EXPECT_EQ(Program().parse({"--version"}), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "1.2\n");
}

}  // namespace
}  // namespace elrom::cli
