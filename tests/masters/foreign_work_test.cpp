#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/ingest/cases_table.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/masters/foreign_program.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::masters {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

/// A solver that has the shipped table of train_000 as its result, after what `script` does to it.
struct Solver {
  test::TemporaryFolder folder;
  ForeignOptions options;
  serve::Claimed claimed;

  explicit Solver(const std::string& script = "cat") {
    folder.write("templates/run.in", "zcat " ELROM_SOURCE_DIR
                                     "/data/formats/fluent_ascii/train_000_comma.txt.gz | " +
                                         script + " > {{case}}.txt\n");
    field::write_mesh(folder / "mesh.h5", field::make_furnace_mesh({}, 10, 21, 33));
    options = {
        .program = {.name = "table, v1",
                    .templates = folder / "templates",
                    .command = "sh run",
                    .time_limit_s = 60,
                    .cfd_case = "{{case}}.txt"},
        .model = "el3d",
        .door = {.mesh = folder / "mesh.h5", .furnace = ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml"},
        .folder = folder / "work"};
    const auto table = ingest::read_cases_table(ELROM_SOURCE_DIR "/data/cases/cases.csv");
    Json inputs;
    for (std::size_t i = 0; i < table.schema.size(); ++i)
      inputs[table.schema[i].name + " [" + table.schema[i].unit + "]"] = table.cases[0].values[i];
    claimed = {.run = 7, .inputs = inputs.dump(), .inputs_digest = std::string(64, 'a'), .load = 0.46};
  }
  serve::Finished work(const std::stop_token& stop = {}) const {
    return foreign_work(options, silent_log())(claimed, stop);
  }
};

TEST(ForeignWork, ACaseComesThroughTheDoorOntoTheReducedMesh) {
  const Solver solver;

  const auto finished = solver.work();

  EXPECT_EQ(finished.version, "table, v1");
  const auto file = solver.folder.write("sent.hdf", finished.fields);
  const auto one = ingest::read_simulation(file);
  EXPECT_EQ(one.record.inputs.name, "el3d_aaaaaaaaaaaa");
  EXPECT_EQ(one.record.inputs.load, 0.46);
  EXPECT_EQ(one.values.cols(), 10 * 21 * 33);
  EXPECT_EQ(one.fields.size(), 9U);
  EXPECT_EQ(Json::parse(solver.claimed.inputs)[one.schema[0].name + " [" + one.schema[0].unit + "]"],
            one.record.inputs.values[0]);
  EXPECT_FALSE(std::filesystem::exists(solver.folder / "work/run_7"));
}

TEST(ForeignWork, WhatPhysicsForbidsReachesNoModel) {
  const Solver solver(R"(awk -F, -v OFS=, 'NR > 1 { $10 = -$10 } { print }')");

  EXPECT_ERROR(serve::WrongResultError, "flow_direction", solver.work());
}

TEST(ForeignWork, AFailingProgramSaysWhyAndItsFolderStays) {
  Solver solver;
  solver.options.program.command = "echo 'Floating point exception'; exit 4";
  EXPECT_ERROR(NumericalError, "ended with status 4", solver.work());
  EXPECT_ERROR(NumericalError, "Floating point exception", solver.work());
  EXPECT_TRUE(std::filesystem::exists(solver.folder / "work/run_7/log.txt"));

  solver.options.program.command = "echo 'no licence'; exit 75";
  EXPECT_ERROR(SystemError, "no licence", solver.work());

  solver.options.program.time_limit_s = 0.1;
  solver.options.program.command = "sleep 60";
  EXPECT_ERROR(NumericalError, "took longer than its time", solver.work());
}

TEST(ForeignWork, IsStoppedWithItsProgram) {
  Solver solver;
  solver.options.program.command = "sleep 60";
  std::stop_source stop;
  stop.request_stop();

  EXPECT_THROW(solver.work(stop.get_token()), Interrupted);
}

TEST(ForeignWork, InputsThatNoFurnaceCanHaveStartNothing) {
  Solver solver;
  solver.claimed.inputs = R"({"primary_air [kg/s]": -5})";

  EXPECT_ERROR(InputError, "impossible primary_air", solver.work());

  EXPECT_TRUE(std::filesystem::is_empty(solver.folder / "work/run_7"));
}

TEST(ForeignWork, ADocumentOfTheProgramIsItsResult) {
  Solver solver;
  solver.options.program.cfd_case.reset();
  solver.options.program.document = "result.json";
  solver.options.program.command = "echo '{\"efficiency\": 0.93}' > result.json";

  const auto finished = solver.work();

  EXPECT_EQ(Json::parse(finished.document)["efficiency"], 0.93);
  EXPECT_TRUE(finished.fields.empty());
  solver.options.program.command = "echo nothing > result.json";
  EXPECT_ERROR(serve::WrongResultError, "no JSON object", solver.work());
}

}  // namespace
}  // namespace elrom::masters
