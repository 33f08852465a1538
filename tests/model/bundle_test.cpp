#include "elrom/model/bundle.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

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

  EXPECT_THAT(message, HasSubstr("found 2.0, expected 1.x"));
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

  EXPECT_THAT(message_of(folder / "a"), HasSubstr("kind 'something-else', expected 'elrom-bundle'"));
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

TEST(Bundle, ADamagedWeightIsFoundWhenItsFieldIsRead) {
  const TemporaryFolder folder;
  sample_bundle().write(folder / "a");
  const auto reader_before = BundleReader(folder / "a");
  const auto& bias = reader_before.file().tensor("fields/pressure/submodel0/build0/layer0/bias");
  const std::string pattern(reinterpret_cast<const char*>(bias.bytes().data()), bias.bytes().size());
  std::string bytes = read_bytes(folder / "a");
  bytes[bytes.find(pattern) + 3] ^= 1;
  write_bytes(folder / "b", bytes);
  const BundleReader reader(folder / "b");

  EXPECT_THROW((void)reader.model("pressure"), InputError);
  EXPECT_NO_THROW((void)reader.model("solid_diameter"));
  EXPECT_NO_THROW((void)reader.model("pressure", false));
  EXPECT_THROW(reader.verify(reader.info().fields, true, 2), InputError);
}

}  // namespace
}  // namespace elrom::model
