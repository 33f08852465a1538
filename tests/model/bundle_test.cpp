#include "elrom/model/bundle.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "elrom/model/banded_networks.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::model {
namespace {

using test::read_bytes;
using test::sample_bundle;
using test::TemporaryFolder;
using test::write_bytes;
using ::testing::HasSubstr;

std::string message_of(const std::filesystem::path& path) {
  try {
    const BundleReader reader(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// The bundle at `path` with one of its texts replaced, digests made anew.
void replace_text(const std::filesystem::path& path, const std::string& key, const std::string& text) {
  auto file = io::TensorFile::open(path);
  file.set_text(key, text);
  file.write(path.string() + ".new");
  std::filesystem::rename(path.string() + ".new", path);
}

TEST(Bundle, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const auto written = sample_bundle();
  written.write(folder / "model.elrom");

  const BundleReader reader(folder / "model.elrom");

  EXPECT_EQ(reader.info().schema, written.info.schema);
  EXPECT_EQ(reader.info().cases, written.info.cases);
  EXPECT_EQ(reader.info().provenance, written.info.provenance);
  ASSERT_EQ(reader.info().fields.size(), 9U);
  EXPECT_EQ(reader.info().fields[2].parity, field::Parity::vector_z);
  EXPECT_EQ(reader.info().fields[8].upper, field::packing_limit);
  EXPECT_EQ(reader.info().fields[0].upper, std::nullopt);
  const auto mesh = reader.mesh();
  EXPECT_EQ(mesh.digest(), written.mesh.digest());
  EXPECT_EQ(reader.mesh_digest(), written.mesh.digest());
  EXPECT_EQ(mesh.corners, written.mesh.corners);
  EXPECT_TRUE(mesh.points == written.mesh.points);
}

TEST(Bundle, CarriesTheFurnaceOfItsCases) {
  const TemporaryFolder folder;
  auto written = sample_bundle();
  written.write(folder / "none.elrom");
  written.furnace = field::Furnace{.name = "f", .solid_density = 2500, .packing_limit = 0.6};
  written.furnace->openings = {{.inputs = "flow_*", .low_m = 1, .high_m = 2}};
  written.write(folder / "model.elrom");

  const BundleReader reader(folder / "model.elrom");

  ASSERT_TRUE(reader.furnace().has_value());
  EXPECT_EQ(field::to_toml(*reader.furnace()), field::to_toml(*written.furnace));
  replace_text(folder / "none.elrom", "format", "1.0");
  EXPECT_FALSE(BundleReader(folder / "none.elrom").furnace().has_value());
  replace_text(folder / "model.elrom", "furnace", "name = 3");
  EXPECT_ERROR(InputError, "model.elrom:furnace:1", BundleReader(folder / "model.elrom").furnace());
}

TEST(Bundle, CarriesWhatIsUsualOfItsCasesAudits) {
  const TemporaryFolder folder;
  auto written = sample_bundle();
  written.write(folder / "none.elrom");
  written.info.usual_audit = {{"solids over inventory", 0.99, 0.02, 64}};
  written.write(folder / "model.elrom");

  EXPECT_TRUE(BundleReader(folder / "none.elrom").info().usual_audit.empty());
  const auto usual = BundleReader(folder / "model.elrom").info().usual_audit;
  ASSERT_EQ(usual.size(), 1U);
  EXPECT_EQ(usual[0].name, "solids over inventory");
  EXPECT_EQ(usual[0].mean, 0.99);
  EXPECT_EQ(usual[0].deviation, 0.02);
  EXPECT_EQ(usual[0].n_cases, 64U);
}

TEST(Bundle, ModelsPredictTheSameBitsAfterwards) {
  const TemporaryFolder folder;
  const auto written = sample_bundle();
  written.write(folder / "model.elrom");
  const BundleReader reader(folder / "model.elrom");
  const auto inputs = test::sample_case();
  const std::vector<std::int32_t> planes{0, 1, 2, 3, 4};
  Workspace workspace;

  for (const auto& [name, model] : written.models) {
    std::vector<float> before(5 * 12), after(5 * 12);
    model->predict({inputs, planes}, before, {}, workspace);
    reader.model(name)->predict({inputs, planes}, after, {}, workspace);
    EXPECT_EQ(before, after) << name;
  }
}

TEST(Bundle, SameContentGivesSameBytes) {
  const TemporaryFolder folder;

  sample_bundle().write(folder / "a");
  sample_bundle().write(folder / "b");

  EXPECT_EQ(read_bytes(folder / "a"), read_bytes(folder / "b"));
}

TEST(Bundle, RejectsNewerMajorVersion) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  replace_text(folder / "a", "format", "2.0");

  const auto message = message_of(folder / "a");

  EXPECT_THAT(message, HasSubstr("found elrom-bundle 2.0, expected elrom-bundle 1.x"));
  EXPECT_THAT(message, HasSubstr("use the ELROM that wrote it"));
}

TEST(Bundle, AcceptsNewerMinorVersion) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  replace_text(folder / "a", "format", "1.7");

  EXPECT_EQ(message_of(folder / "a"), "no error");
}

TEST(Bundle, RejectsAnotherKindOfTensorFile) {
  const TemporaryFolder folder;
  io::TensorFile other;
  other.set_text("kind", "something-else");
  other.write(folder / "a");

  EXPECT_THAT(message_of(folder / "a"), HasSubstr("found something-else, expected elrom-bundle"));
}

TEST(Bundle, RejectsABrokenDescription) {
  const TemporaryFolder folder;
  for (const char* text : {"", "[]", "{}", "{\"method\":1}", "not json"}) {
    sample_bundle().write(folder / "a");
    replace_text(folder / "a", "bundle", text);
    EXPECT_THAT(message_of(folder / "a"), HasSubstr("broken bundle description")) << text;
  }
}

TEST(Bundle, UnknownFieldNamesTheNearest) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  const BundleReader reader(folder / "a");

  try {
    (void)reader.model("presure");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'pressure'?"));
  }
}

TEST(Bundle, UnknownKindOfModelIsRefused) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  replace_text(folder / "a", "fields/pressure", R"({"kind":"oracle"})");
  const BundleReader reader(folder / "a");

  try {
    (void)reader.model("pressure");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("unknown kind of model 'oracle'"));
  }
}

/// Copies a bundle with one bit of a tensor turned over.
void damage(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& tensor) {
  const BundleReader reader(from);
  const auto& good = reader.file().tensor(tensor);
  const std::string pattern(reinterpret_cast<const char*>(good.bytes().data()), good.bytes().size());
  std::string bytes = read_bytes(from);
  bytes[bytes.find(pattern) + 3] ^= 1;
  write_bytes(to, bytes);
}

// A bundle that is made to do harm has true digests: what it says is checked against what it holds.
TEST(Bundle, RefusesSizesThatItHasNoCellsFor) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  auto description = io::TensorFile::open(folder / "a").text("bundle");
  const std::string planes = "\"n_planes\":5";
  description.replace(description.find(planes), planes.size(), "\"n_planes\":100000000");
  replace_text(folder / "a", "bundle", description);

  EXPECT_THAT(message_of(folder / "a"), HasSubstr("mesh/centre: expected centres of 1200000000 cells"));
}

TEST(Bundle, RefusesAModelOfOtherPlanes) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  auto description = io::TensorFile::open(folder / "a").text("fields/pressure");
  const std::string planes = "\"planes\":5";
  description.replace(description.find(planes), planes.size(), "\"planes\":4");
  replace_text(folder / "a", "fields/pressure", description);
  const BundleReader reader(folder / "a");

  EXPECT_ERROR(InputError, "found 4 inputs, 4 planes, 12 columns, expected 4 inputs, 5 planes, 12 columns",
               reader.model("pressure"));
}

TEST(Bundle, RefusesAModelOfOtherInputs) {
  const TemporaryFolder folder;
  auto bundle = sample_bundle();
  base::Random random(base::Seed(1));
  test::BundleSize other;
  other.n_inputs = 3;
  bundle.models["pressure"] =
      test::random_networks(bundle.info.fields[6], test::sample_inputs(other, random), other, random);
  bundle.write(folder / "a");

  EXPECT_ERROR(InputError, "found 3 inputs, 5 planes, 12 columns",
               BundleReader(folder / "a").model("pressure"));
}

TEST(Bundle, RefusesIntervalsOfAnotherMesh) {
  const TemporaryFolder folder;
  auto bundle = sample_bundle();
  bundle.uncertainty["pressure"] = std::make_shared<Uncertainty>(MatrixF(MatrixF::Random(6, 24)), 12);
  bundle.write(folder / "a");

  EXPECT_ERROR(InputError, "scale: found (2, 12), expected (5, 12)",
               BundleReader(folder / "a").uncertainty("pressure"));
}

TEST(Bundle, ADamagedWeightIsFoundWhenItsFieldIsRead) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  damage(folder / "a", folder / "b", "fields/pressure/submodel0/build0/layer0/bias");
  const BundleReader reader(folder / "b");

  EXPECT_THROW((void)reader.model("pressure"), InputError);
  EXPECT_NO_THROW((void)reader.model("solid_diameter"));
  EXPECT_NO_THROW((void)BundleReader(folder / "b", io::Verify::never).model("pressure"));
}

TEST(Bundle, TheBestBuildIsReadWithoutTheOthers) {
  const TemporaryFolder folder;
  const auto written = sample_bundle();
  written.write(folder / "a");
  const auto& networks = dynamic_cast<const BandedNetworks&>(*written.models.at("pressure"));
  const auto& submodel = networks.parts().submodels.front();
  ASSERT_GT(submodel.builds.size(), 1U);

  for (std::size_t b = 0; b < submodel.builds.size(); ++b) {
    damage(folder / "a", folder / "b",
           "fields/pressure/submodel0/build" + std::to_string(b) + "/layer0/bias");
    const BundleReader reader(folder / "b");
    if (b == submodel.best()) {
      EXPECT_THROW((void)reader.model("pressure", {.best_build_only = true}), InputError);
    } else {
      EXPECT_NO_THROW((void)reader.model("pressure", {.best_build_only = true}));
    }
  }
}

TEST(Bundle, SomePlanesOfTheMeshAreRowsOfTheWhole) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  const BundleReader reader(folder / "a");
  const auto whole = reader.mesh();

  const auto part = reader.mesh({.planes = {1, 3}});

  ASSERT_EQ(part.n_cells(), 2 * reader.n_columns());
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const auto cell = (i < reader.n_columns() ? 1 : 2) * reader.n_columns() + i;
    EXPECT_EQ(part.centre.row(static_cast<Eigen::Index>(i)),
              whole.centre.row(static_cast<Eigen::Index>(cell)));
    EXPECT_EQ(part.volume[i], whole.volume[cell]);
    EXPECT_EQ(part.corners[8 * i + 5], whole.corners[8 * cell + 5]);
  }
  EXPECT_THROW((void)reader.mesh({.planes = {99}}), UsageError);
}

}  // namespace
}  // namespace elrom::model
