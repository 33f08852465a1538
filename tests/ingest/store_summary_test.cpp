#include "elrom/ingest/store_summary.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/ingest/generate.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

using ::testing::HasSubstr;

TEST(StoreSummary, GivesRangesInTheUsersUnits) {
  test::TemporaryFolder folder;
  generate({.store = folder / "g.h5", .n_cases = 3, .n_planes = 4, .n_columns = 6}, silent_log());
  const auto store = field::SnapshotStore::open(folder / "g.h5");

  const auto description = describe_store(store);

  EXPECT_EQ(description["n_cases"], 3);
  EXPECT_EQ(description["cases"].size(), 3U);
  const auto& inventory = description["inputs"][21];
  EXPECT_EQ(inventory["name"], "solids_inventory");
  EXPECT_EQ(inventory["unit"], "t");
  EXPECT_GT(inventory["min"], 70);
  EXPECT_LT(inventory["max"], 130);
  const auto pressure = store.read("pressure", store.find("*"));
  EXPECT_FLOAT_EQ(description["fields"][6]["max"].get<float>(), pressure.maxCoeff());
  EXPECT_NEAR(description["fields"][6]["mean"].get<double>(), static_cast<double>(pressure.mean()),
              1e-3 * static_cast<double>(pressure.maxCoeff()));
}

TEST(StoreSummary, WordsNameCasesInputsAndFields) {
  test::TemporaryFolder folder;
  generate({.store = folder / "g.h5", .n_cases = 2, .n_planes = 4, .n_columns = 6}, silent_log());

  const auto words = in_words(describe_store(field::SnapshotStore::open(folder / "g.h5")));

  EXPECT_THAT(words, HasSubstr("2 cases, loads"));
  EXPECT_THAT(words, HasSubstr("4 planes x 6 columns = 24 cells"));
  EXPECT_THAT(words, HasSubstr("train_001"));
  EXPECT_THAT(words, HasSubstr("gas_temperature               degC"));
  EXPECT_THAT(words, HasSubstr("solid_diameter                m"));
}

TEST(StoreSummary, ShowsTheFurnace) {
  test::TemporaryFolder folder;
  generate({.store = folder / "g.h5", .n_cases = 2, .n_planes = 4, .n_columns = 6}, silent_log());
  auto bundle = test::sample_bundle({});
  bundle.write(folder / "none.elrom");
  bundle.furnace = field::read_furnace(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml");
  bundle.write(folder / "model.elrom");

  const auto store = describe_store(field::SnapshotStore::open(folder / "g.h5"));
  const auto described = describe_bundle(model::BundleReader(folder / "model.elrom"));

  EXPECT_EQ(store["furnace"]["name"], "generated");
  EXPECT_EQ(store["furnace"]["openings"].size(), 21U);
  EXPECT_EQ(described["furnace"]["openings"][7]["inputs"], "secondary_*_upper_*");
  EXPECT_EQ(described["furnace"]["held_out"][0], "load_*");
  const auto words = in_words(described);
  EXPECT_THAT(
      words,
      HasSubstr("furnace: Lagisza CFB boiler; solids of 2400 kg/m3, packing limit 0.65; outlet from 41.3 m"));
  EXPECT_THAT(words, HasSubstr("mirrors left-right, front-rear; held out load_*, rep*; repeated runs rep*"));
  EXPECT_THAT(words, HasSubstr("burner_*                    burner          4.273 to 5.697 m"));
  const auto none = describe_bundle(model::BundleReader(folder / "none.elrom"));
  EXPECT_TRUE(none["furnace"].is_null());
  EXPECT_THAT(in_words(none), HasSubstr("furnace: not described"));
}

TEST(StoreSummary, DescribesACaseAndAMesh) {
  const auto one = describe_case(read_el3d(ELROM_SOURCE_DIR "/data/cases/load_064.h5"));
  const auto mesh = describe_mesh(field::read_mesh(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5"));

  EXPECT_EQ(one["n_cells"], 6930);
  EXPECT_NEAR(one["inputs"][22]["value"].get<double>(), 263.297, 1e-3);
  EXPECT_THAT(in_words(one), HasSubstr("case load_064: load 64.0 %"));
  auto without_load = one;
  without_load["load"] = nullptr;
  EXPECT_THAT(in_words(without_load), HasSubstr("case load_064: averaged"));
  EXPECT_EQ(mesh["n_cells"], 55440);
  EXPECT_THAT(in_words(mesh), HasSubstr("66 planes x 840 columns"));
}

TEST(StoreSummary, DescribesABundle) {
  test::TemporaryFolder folder;
  test::sample_bundle({}).write(folder / "model.elrom");
  const model::BundleReader reader(folder / "model.elrom");

  const auto description = describe_bundle(reader);

  EXPECT_EQ(description["cases"].size(), 12U);
  EXPECT_EQ(description["fields"][0]["model"], "networks");
  EXPECT_EQ(description["digest"], reader.digest());
  EXPECT_THAT(in_words(description), HasSubstr("trained on 12 cases"));
}

}  // namespace
}  // namespace elrom::ingest
