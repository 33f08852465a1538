// Every reader that a study can reach asks for its file's kind and version by the one check
// (elrom/io/file_kind.hpp). Those of reports, predictions and checkpoints are tested beside theirs.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/networks/trial_store.hpp"
#include "elrom/sql/database.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/timing.hpp"
#include "study_fixture.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"
#include "timing.hpp"

namespace elrom::study {
namespace {

using Path = std::filesystem::path;

void mark_hdf5(const Path& path, const io::FileKind& as) {
  auto file = io::Hdf5File::open(path, io::Hdf5File::Access::edit);
  io::write_kind(file, as);
  file.close();
}

void mark_tensors(const Path& path, const io::FileKind& as) {
  io::TensorFile copy;
  const auto file = io::TensorFile::open(path);
  for (const auto& [name, tensor] : file.tensors()) copy.set(name, tensor);
  for (const auto& [key, text] : file.texts()) copy.set_text(key, text);
  io::write_kind(copy, as);
  copy.write(path);
}

void mark_json(const Path& path, const io::FileKind& as) {
  auto root = nlohmann::json::parse(base::read_text(path));
  root.update(io::json_head<nlohmann::json>(as));
  base::write_text(path, root.dump());
}

void mark_sqlite(const Path& path, const io::FileKind& as) {
  const sql::Database database(path, io::kinds::trials, "");
  const auto set = [&](const std::string& key, const std::string& value) {
    database.prepare("UPDATE about SET value = ? WHERE key = ?").bind(1, value).bind(2, key).next();
  };
  set("kind", std::string(as.name));
  set("format_major", std::to_string(as.version.major));
  set("format_minor", std::to_string(as.version.minor));
}

struct Reader {
  io::FileKind kind;
  std::function<void(const Path&)> write, read;
  std::function<void(const Path&, const io::FileKind&)> mark;
};

const std::vector<Reader> readers{
    {io::kinds::mesh, [](const Path& p) { field::write_mesh(p, field::make_furnace_mesh({}, 2, 2, 2)); },
     [](const Path& p) { (void)field::read_mesh(p); }, mark_hdf5},
    {io::kinds::snapshots, [](const Path& p) { write_small_store(p, 2); },
     [](const Path& p) { (void)field::SnapshotStore::open(p); }, mark_hdf5},
    {io::kinds::bundle, [](const Path& p) { test::sample_bundle().write(p); },
     [](const Path& p) { (void)model::BundleReader(p); }, mark_tensors},
    {io::kinds::split,
     [](const Path& p) {
       write_split(p, {"case", {"a"}, {}, {}, {}});
     },
     [](const Path& p) { (void)read_split(p); }, mark_json},
    {io::kinds::timing, [](const Path& p) { write_timing(p, {}, 1, 1); },
     [](const Path& p) { (void)read_timing(p); }, mark_json},
    {io::kinds::trials, [](const Path& p) { (void)networks::TrialStore(p); },
     [](const Path& p) { (void)networks::TrialStore(p); }, mark_sqlite}};

class EveryReader : public ::testing::TestWithParam<Reader> {
 protected:
  EveryReader() { GetParam().write(path_); }
  /// What the reader says of a file that says this of itself; empty: it reads it.
  [[nodiscard]] std::string said(std::string_view kind, int major, int minor) const {
    GetParam().mark(path_, {kind, {major, minor}, ""});
    try {
      GetParam().read(path_);
      return {};
    } catch (const InputError& error) {
      return error.what();
    }
  }
  const test::TemporaryFolder folder_;
  const Path path_ = folder_ / "file";
  const io::FileKind kind_ = GetParam().kind;
  const std::string name_{kind_.name};
};

TEST_P(EveryReader, TakesItsOwnMajorVersionWithAnyMinorOne) {
  EXPECT_EQ(said(name_, kind_.version.major, kind_.version.minor), "");
  EXPECT_EQ(said(name_, kind_.version.major, kind_.version.minor + 3), "");
}

TEST_P(EveryReader, RefusesANewerMajorVersion) {
  EXPECT_THAT(
      said(name_, kind_.version.major + 1, 0),
      ::testing::HasSubstr("found " + name_ + " " + std::to_string(kind_.version.major + 1) +
                           ".0, expected " + name_ + " " + std::to_string(kind_.version.major) + ".x"));
}

TEST_P(EveryReader, RefusesAnOlderMajorVersion) {
  EXPECT_THAT(said(name_, kind_.version.major - 1, 9), ::testing::HasSubstr("another format version"));
}

TEST_P(EveryReader, RefusesAnotherKind) {
  EXPECT_THAT(said("elrom-cost", kind_.version.major, 0),
              ::testing::HasSubstr("found elrom-cost, expected " + name_));
}

INSTANTIATE_TEST_SUITE_P(, EveryReader, ::testing::ValuesIn(readers), [](const auto& test) {
  std::string name(test.param.kind.name);
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace elrom::study
