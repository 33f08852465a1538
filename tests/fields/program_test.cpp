// elrom-predict as its users run it: a process, its files, its exit status.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>

#include "elrom/base/text.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/io/tensor_file.hpp"
#include "support/outcome.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::fields {
namespace {

using ::testing::HasSubstr;

using test::Outcome;

class ProgramTest : public ::testing::Test {
 protected:
  const test::TemporaryFolder folder_;

  void SetUp() override {
    test::sample_bundle().write(folder_ / "model.elrom");
    test::write_bytes(folder_ / "cases.csv",
                      "case,load,flow_0 [kg/s],flow_1 [kg/s],flow_2 [kg/s],flow_3 [kg/s]\n"
                      "good,0.7,7,14,21,28\nfar,0.7,700,14,21,28\nother,0.8,8,16,24,32\n");
  }
  /// With the sample's bundle and cases.
  [[nodiscard]] Outcome predict(const std::string& arguments, bool with_errors = true) const {
    return run("--bundle '" + (folder_ / "model.elrom").string() + "' --cases '" +
                   (folder_ / "cases.csv").string() + "' " + arguments,
               with_errors);
  }
  [[nodiscard]] static Outcome run(const std::string& arguments, bool with_errors = true) {
    return test::outcome_of(ELROM_BIN_DIR "/elrom-predict " + arguments +
                            (with_errors ? " 2>&1" : " 2>/dev/null"));
  }
  [[nodiscard]] std::string output(const std::string& name) const {
    return "--output '" + (folder_ / name).string() + "'";
  }
  [[nodiscard]] std::vector<float> field(const std::string& file,
                                         const std::string& name = "pressure") const {
    return io::Hdf5File::open(folder_ / file).dataset("elrom/fields/" + name).read<float>();
  }
  [[nodiscard]] std::vector<std::string> files_in(const std::string& name) const {
    std::vector<std::string> names;
    if (!std::filesystem::exists(folder_ / name)) return names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / name))
      names.push_back(entry.path().filename().string());
    return names;
  }
};

TEST_F(ProgramTest, RefusesABundleWithAChangedByteInAModel) {
  const auto path = folder_ / "model.elrom";
  auto bytes = test::read_bytes(path);
  {
    const auto file = io::TensorFile::open(path);
    const auto weights = std::ranges::find_if(
        file.tensors(), [](const auto& tensor) { return tensor.first.ends_with("/layer0/weights"); });
    const auto values = weights->second.bytes();
    bytes[bytes.find({reinterpret_cast<const char*>(values.data()), values.size()})] ^= 1;
  }
  test::write_bytes(path, bytes);

  for (const std::string threads : {"1", "2"}) {
    const auto outcome = predict(output("out") + " --threads " + threads);

    EXPECT_EQ(outcome.status, 3);
    EXPECT_THAT(outcome.text, HasSubstr("/layer0/weights: found"));
  }
}

TEST_F(ProgramTest, WritesOneFileACaseAndNothingElse) {
  const auto outcome = predict(output("out"));

  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(files_in("out"), ::testing::UnorderedElementsAre("good.hdf", "far.hdf", "other.hdf"));
  const auto lines = base::split(outcome.text, '\n');
  EXPECT_THAT(lines[0], ::testing::StartsWith("good: inside"));
  EXPECT_THAT(lines[1], ::testing::StartsWith("far: outside, flow_0 2520 t/h (trained "));
}

TEST_F(ProgramTest, StrictLeavesOutsideCasesOutAndExitsWith4) {
  const auto outcome = predict("--strict " + output("out"));

  EXPECT_EQ(outcome.status, 4) << outcome.text;
  EXPECT_THAT(files_in("out"), ::testing::UnorderedElementsAre("good.hdf", "other.hdf"));
  EXPECT_THAT(outcome.text, HasSubstr("1 of 3 cases outside"));
}

TEST_F(ProgramTest, PartsAreBitsOfTheWholeInEveryThreadCount) {
  ASSERT_EQ(predict(output("all") + " --threads 1").status, 0);
  ASSERT_EQ(predict(output("some") + " --planes 1:3 --fields pressure --threads 3 --case good").status, 0);
  ASSERT_EQ(predict(output("box") + " --region 0:5.3,:,20: --threads 2 --case good").status, 0);

  const auto all = field("all/good.hdf"), some = field("some/good.hdf"), box = field("box/good.hdf");
  EXPECT_EQ(some, std::vector<float>(all.begin() + 12, all.begin() + 36));
  const auto cells =
      io::Hdf5File::open(folder_ / "box/good.hdf").dataset("elrom/mesh/cells").read<std::int32_t>();
  ASSERT_EQ(cells.size(), box.size());
  for (std::size_t i = 0; i < cells.size(); ++i) EXPECT_EQ(box[i], all[static_cast<std::size_t>(cells[i])]);
}

TEST_F(ProgramTest, ATableAndSingleCasesGiveTheSameBytes) {
  ASSERT_EQ(predict(output("table") + " --threads 2").status, 0);
  ASSERT_EQ(predict(output("single") + " --case other").status, 0);

  EXPECT_EQ(test::read_bytes(folder_ / "table/other.hdf"), test::read_bytes(folder_ / "single/other.hdf"));
}

TEST_F(ProgramTest, ProfilesAreAveragesOfTheCells) {
  ASSERT_EQ(predict(output("profile") + " --profile --case good").status, 0);
  ASSERT_EQ(predict(output("all") + " --case good").status, 0);

  const auto profile =
      io::Hdf5File::open(folder_ / "profile/good.hdf").dataset("elrom/profiles/pressure").read<float>();
  const auto cells = field("all/good.hdf");
  ASSERT_EQ(profile.size(), 5U);
  double sum = 0;  // all cells of a plane are alike in volume
  for (std::size_t c = 0; c < 12; ++c) sum += cells[4 * 12 + c];
  EXPECT_NEAR(profile[4], sum / 12, 1e-5 * sum / 12);
}

TEST_F(ProgramTest, StreamsTextToStandardOutput) {
  const auto outcome = predict("--case good --fields pressure --planes 0 --output -", false);

  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.text, ::testing::StartsWith("plane,column,x [m],y [m],z [m],pressure [Pa]\n0,0,"));
  EXPECT_EQ(base::split(outcome.text, '\n').size(), 14U);
}

TEST_F(ProgramTest, WritesEveryFormatAtOnce) {
  ASSERT_EQ(predict(output("out") + " --case good --format hdf,csv,hdf,txt,ip --uncertainty 0.8").status, 0);

  EXPECT_THAT(files_in("out"),
              ::testing::UnorderedElementsAre("good.hdf", "good.csv", "good.txt", "good.ip"));
  EXPECT_THAT(test::read_bytes(folder_ / "out/good.csv"), HasSubstr("pressure_half_width [Pa]"));
}

TEST_F(ProgramTest, MistakesGetOneLineAndTheirExitStatus) {
  const std::pair<const char*, int> mistakes[] = {
      {"--fields presure", 2}, {"--planes 0:6", 2},    {"--region 1:2", 2},     {"--case nobody", 2},
      {"--set flw_0=3", 3},    {"--uncertainty 2", 2}, {"--frmat csv", 2},      {"--output - --format ip", 2},
      {"--format 0", 2},       {"--set flow_0=-3", 3}, {"--sweep flow_0=1", 2}, {"--set flow_0=nonsense", 2}};
  for (const auto& [arguments, status] : mistakes) {
    const auto outcome = predict(std::string(arguments) + " " +
                                 (std::string(arguments).starts_with("--output - ") ? "" : output("out")));
    const bool user_error = outcome.status == 2 || outcome.status == 3;
    EXPECT_TRUE(status == outcome.status || (user_error && std::string(arguments).starts_with("--set")))
        << arguments << ": " << outcome.status;
    EXPECT_EQ(base::split(outcome.text, '\n').size(), 2U) << outcome.text;
    EXPECT_THAT(files_in("out"), ::testing::IsEmpty());
  }
}

TEST_F(ProgramTest, DamagedOrWrongBundlesExitWith3) {
  std::string bytes = test::read_bytes(folder_ / "model.elrom");
  bytes[bytes.size() - 200] ^= 1;
  test::write_bytes(folder_ / "model.elrom", bytes);
  EXPECT_EQ(predict(output("out")).status, 3);

  test::write_bytes(folder_ / "model.elrom", bytes.substr(0, 1000));
  EXPECT_EQ(predict(output("out")).status, 3);

  std::filesystem::copy_file(folder_ / "cases.csv", folder_ / "model.elrom",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(predict(output("out")).status, 3);
  EXPECT_THAT(files_in("out"), ::testing::IsEmpty());
}

TEST_F(ProgramTest, AStoreOrPredictionGivenAsBundleIsCalledWhatItIs) {
  ASSERT_EQ(predict(output("out") + " --case good").status, 0);
  const auto wrong = run("--bundle '" + (folder_ / "out/good.hdf").string() + "' --cases '" +
                         (folder_ / "cases.csv").string() + "' " + output("more"));

  EXPECT_EQ(wrong.status, 3);
  EXPECT_THAT(wrong.text, HasSubstr("--bundle is a prediction, not a bundle"));
}

TEST_F(ProgramTest, AnOutputThatIsAFileIsRefusedByUs) {
  const auto outcome = predict(output("cases.csv"));

  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.text, HasSubstr("--output is a file, not a folder"));
}

TEST_F(ProgramTest, AWrongFormatListsTheNames) {
  EXPECT_THAT(predict(output("out") + " --format 0").text, HasSubstr("expected hdf, csv, txt, ip"));
}

TEST_F(ProgramTest, ASettingLeavesTheBaseCasesFileAlone) {
  ASSERT_EQ(predict(output("out") + " --case good").status, 0);
  const auto before = test::read_bytes(folder_ / "out/good.hdf");

  ASSERT_EQ(predict(output("out") + " --case good --set 'flow_0=7.5kg/s'").status, 0);

  EXPECT_EQ(test::read_bytes(folder_ / "out/good.hdf"), before);
  EXPECT_THAT(files_in("out"), ::testing::UnorderedElementsAre("good.hdf", "good+flow_0=7.5kg_s.hdf"));
}

TEST_F(ProgramTest, ASweepWritesASummaryAndAPageOfCurves) {
  const auto outcome =
      predict(output("out") + " --case good --format csv --sweep 'flow_0=7:8:0.5 kg/s' --page '" +
              (folder_ / "page.html").string() + "'");

  ASSERT_EQ(outcome.status, 0) << outcome.text;
  const auto lines = base::split(test::read_bytes(folder_ / "out/summary.csv"), '\n');
  ASSERT_EQ(lines.size(), 6U);  // headings, base, three values, the end
  const auto headings = base::split(lines[0], ','), base_case = base::split(lines[1], ','),
             last = base::split(lines[4], ',');
  const auto at = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(headings, name) - headings.begin());
  };
  EXPECT_EQ(last[0], "good+flow_0=8kg_s");
  EXPECT_EQ(last[1], "good");
  EXPECT_EQ(last[at("flow_0 [kg/s]")], "8");
  EXPECT_EQ(last[at("held")], "3 other inputs at the values of good");
  const double mean = std::stod(last[at("pressure mean [Pa]")]);
  EXPECT_NEAR(std::stod(last[at("change of pressure mean [Pa]")]),
              mean - std::stod(base_case[at("pressure mean [Pa]")]), 1e-5 * std::abs(mean));
  EXPECT_THAT(
      test::read_bytes(folder_ / "page.html"),
      ::testing::AllOf(HasSubstr("<polyline"), HasSubstr("pressure mean [Pa]"), HasSubstr("</html>")));
}

TEST_F(ProgramTest, WhereThePageCannotLieIsKnownBeforeAnyCaseIsPredicted) {
  const std::string sweep = " --case good --sweep 'flow_0=7:8:0.5 kg/s' --page '";
  const auto refused = predict(output("out") + sweep + (folder_ / "cases.csv/page.html").string() + "'");
  EXPECT_EQ(refused.status, 1);
  EXPECT_EQ(base::split(refused.text, '\n').size(), 2U) << refused.text;
  EXPECT_THAT(files_in("out"), ::testing::IsEmpty());

  EXPECT_EQ(predict(output("out") + sweep + (folder_ / "new/folder/page.html").string() + "'").status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "new/folder/page.html"));
}

/// A process id that was somebody's and is nobody's now.
std::string dead_process() { return base::trim(test::outcome_of("sh -c 'echo $$'").text); }

TEST_F(ProgramTest, WhatKilledRunsLeftHalfWrittenIsClearedAway) {
  std::filesystem::create_directories(folder_ / "out");
  const auto dead = dead_process();
  for (const std::string name : {".good.hdf.", ".summary.csv.", ".good.csv."})
    test::write_bytes(folder_ / ("out/" + name + dead + ".3.tmp"), "half");

  ASSERT_EQ(predict(output("out") + " --case good").status, 0);

  EXPECT_THAT(files_in("out"), ::testing::UnorderedElementsAre("good.hdf", ".summary.csv." + dead + ".3.tmp",
                                                               ".good.csv." + dead + ".3.tmp"))
      << "of what this run writes, and nothing else";
}

TEST_F(ProgramTest, SeveralCasesStreamWithACaseColumnInTheTablesOrder) {
  const auto outcome = predict("--fields pressure --planes 0 --output - --threads 2", false);

  ASSERT_EQ(outcome.status, 0);
  const auto lines = base::split(outcome.text, '\n');
  ASSERT_EQ(lines.size(), 1 + 3 * 12 + 1);
  EXPECT_EQ(lines[0], "case,plane,column,x [m],y [m],z [m],pressure [Pa]");
  EXPECT_THAT(lines[1], ::testing::StartsWith("good,0,0,"));
  EXPECT_THAT(lines[13], ::testing::StartsWith("far,0,0,"));
  EXPECT_THAT(lines[36], ::testing::StartsWith("other,0,11,"));
}

TEST_F(ProgramTest, CasesComeFromStandardInputToo) {
  const auto outcome = run("--bundle '" + (folder_ / "model.elrom").string() + "' --cases - " +
                           output("out") + " < '" + (folder_ / "cases.csv").string() + "'");

  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_EQ(files_in("out").size(), 3U);
}

TEST_F(ProgramTest, ALongTableIsCountedNotListed) {
  const std::string sweep = " --case good --profile --sweep 'flow_0=7:8:0.01 kg/s'";
  const auto counted = predict(output("out") + sweep);
  const auto listed = predict(output("out") + sweep + " --verbose");

  EXPECT_THAT(counted.text, ::testing::StartsWith("102 cases: "));
  EXPECT_EQ(base::split(counted.text, '\n').size(), 3U);  // counts, summary, the end
  EXPECT_GT(base::split(listed.text, '\n').size(), 102U);
}

TEST_F(ProgramTest, HelpIsNoError) {
  EXPECT_EQ(run("--help").status, 0);
  EXPECT_THAT(run("--help").text, HasSubstr("--strict"));
  EXPECT_THAT(run("--help").text, HasSubstr("All other inputs are held at the base's values"));
  EXPECT_EQ(run("").status, 2);
}

TEST_F(ProgramTest, TimingTellsColdFromWarm) {
  EXPECT_THAT(predict(output("out") + " --timing --case good").text,
              HasSubstr("in the page cache before (warm)"));
}

}  // namespace
}  // namespace elrom::fields
