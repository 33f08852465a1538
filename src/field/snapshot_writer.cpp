#include <algorithm>
#include <cmath>
#include <optional>

#include "case_entries.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "snapshot_layout.hpp"

namespace elrom::field {

namespace {

std::filesystem::path lock_path(const std::filesystem::path& store) {
  return store.parent_path() / ("." + store.filename().string() + ".lock");
}

// Temporaries that killed writers left behind; the lock is held, so they are nobody's.
const std::filesystem::path& without_remains(const std::filesystem::path& store) {
  const auto prefix = "." + store.filename().string() + ".";
  const auto folder = store.has_parent_path() ? store.parent_path() : std::filesystem::path(".");
  std::error_code fault;
  for (const auto& entry : std::filesystem::directory_iterator(folder, fault)) {
    const auto name = entry.path().filename().string();
    if (name.starts_with(prefix) && name.ends_with(".tmp")) std::filesystem::remove(entry.path(), fault);
  }
  return store;
}

std::string content_digest(const MatrixF& fields) {
  return base::sha256(std::as_bytes(std::span(fields.data(), static_cast<std::size_t>(fields.size()))));
}

void expect_same_mesh(const SnapshotStore& store, const Mesh& mesh) {
  const auto ours = mesh.digest(), theirs = store.mesh().digest();
  if (ours == theirs) return;
  const auto text = [](const Mesh& m, const std::string& digest) {
    return std::to_string(m.n_planes) + " planes x " + std::to_string(m.n_columns) + " columns, digest " +
           digest.substr(0, 12);
  };
  throw InputError({.what = "store of another mesh",
                    .where = store.path().string(),
                    .found = text(store.mesh(), theirs),
                    .expected = text(mesh, ours)});
}

void expect_same_schema(const SnapshotStore& store, const InputSchema& schema) {
  const auto text = [](const InputSchema& s, std::size_t i) {
    return i < s.size() ? s[i].name + " [" + s[i].unit + "]" : std::string("nothing");
  };
  for (std::size_t i = 0; i < std::max(schema.size(), store.schema().size()); ++i) {
    if (text(schema, i) == text(store.schema(), i)) continue;
    throw InputError({.what = "store with other boundary conditions",
                      .where = store.path().string(),
                      .found = text(store.schema(), i) + " as number " + std::to_string(i + 1),
                      .expected = text(schema, i)});
  }
}

void expect_same_fields(const SnapshotStore& store, const std::vector<FieldInfo>& fields) {
  const auto text = [](const std::vector<FieldInfo>& f, std::size_t i) {
    return i < f.size() ? f[i].name + " [" + f[i].unit + "]" : std::string("nothing");
  };
  for (std::size_t i = 0; i < std::max(fields.size(), store.fields().size()); ++i) {
    if (text(fields, i) == text(store.fields(), i)) continue;
    throw InputError({.what = "store with other fields",
                      .where = store.path().string(),
                      .found = text(store.fields(), i) + " as number " + std::to_string(i + 1),
                      .expected = text(fields, i)});
  }
}

}  // namespace

struct SnapshotWriter::Impl {
  std::filesystem::path path;
  std::size_t n_planes, n_columns, n_inputs;
  std::vector<FieldInfo> fields;
  base::FileLock lock;
  base::AtomicFile target;
  std::optional<io::Hdf5File> file;
  std::vector<CaseRecord> cases;

  void start_new(const Mesh& mesh, const InputSchema& schema) {
    file = io::Hdf5File::create(target.temporary());
    io::write_kind(*file, io::kinds::snapshots);
    write_mesh(file->create_group("mesh"), mesh);
    detail::write_schema(*file, schema);
    detail::create_fields(*file, fields, mesh);
  }

  void continue_from_old(const Mesh& mesh, const InputSchema& schema) {
    {
      const auto old = SnapshotStore::open(path);
      expect_same_mesh(old, mesh);
      expect_same_schema(old, schema);
      expect_same_fields(old, fields);
      cases = old.cases();
    }
    std::filesystem::copy_file(path, target.temporary());
    file = io::Hdf5File::open(target.temporary(), io::Hdf5File::Access::edit);
  }

  void expect_new(const CaseRecord& record) const {
    for (const auto& one : cases) {
      if (one.inputs.name == record.inputs.name) {
        throw InputError(
            {.what = "case '" + record.inputs.name + "' is already in the store", .where = path.string()});
      }
      if (one.content_digest == record.content_digest) {
        throw InputError({.what = "case '" + record.inputs.name + "' has the same fields as case '" +
                                  one.inputs.name + "'",
                          .where = path.string(),
                          .advice = "the same result under two names would be counted twice"});
      }
    }
  }

  void expect_complete(const Snapshot& snapshot) const {
    const auto& name = snapshot.record.inputs.name;
    detail::check_case_name(name, path.string());
    check(snapshot.record.inputs.values.size() == n_inputs, "a case with the wrong number of inputs");
    check(snapshot.fields.rows() == static_cast<Eigen::Index>(fields.size()),
          "a case with the wrong number of fields");
    check(snapshot.fields.cols() == static_cast<Eigen::Index>(n_planes * n_columns),
          "a case on another mesh");
    const auto& errors = snapshot.record.resampling_error;
    check(errors.empty() || errors.size() == fields.size(),
          "resampling errors of the wrong number of fields");
    const auto& values = snapshot.record.inputs.values;
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
      throw InputError({.what = "a boundary condition that is not finite", .where = "case '" + name + "'"});
    }
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (snapshot.fields.row(static_cast<Eigen::Index>(f)).allFinite()) continue;
      throw InputError(
          {.what = "a value that is not finite", .where = "case '" + name + "', field " + fields[f].name});
    }
  }
};

SnapshotWriter::SnapshotWriter(const std::filesystem::path& path, const Mesh& mesh, const InputSchema& schema,
                               const std::vector<FieldInfo>& fields)
    : impl_(new Impl{path,
                     mesh.n_planes,
                     mesh.n_columns,
                     schema.size(),
                     fields,
                     base::FileLock(lock_path(path)),
                     base::AtomicFile(without_remains(path)),
                     std::nullopt,
                     {}}) {
  if (std::filesystem::exists(path)) {
    impl_->continue_from_old(mesh, schema);
  } else {
    impl_->start_new(mesh, schema);
  }
}

SnapshotWriter::~SnapshotWriter() = default;

void SnapshotWriter::add(const Snapshot& snapshot) {
  impl_->expect_complete(snapshot);
  auto record = snapshot.record;
  record.content_digest = content_digest(snapshot.fields);
  impl_->expect_new(record);
  const auto i_case = impl_->cases.size();
  for (std::size_t f = 0; f < impl_->fields.size(); ++f) {
    const auto dataset = impl_->file->dataset("fields/" + impl_->fields[f].name);
    dataset.extend(i_case + 1);
    const auto row = snapshot.fields.row(static_cast<Eigen::Index>(f));
    dataset.write_slab<float>({i_case, 0, 0}, {1, impl_->n_planes, impl_->n_columns},
                              {row.data(), static_cast<std::size_t>(row.size())});
  }
  impl_->cases.push_back(std::move(record));
}

void SnapshotWriter::commit() {
  detail::write_cases(*impl_->file, impl_->cases, impl_->n_inputs, impl_->fields.size());
  impl_->file->close();
  impl_->target.commit();
}

}  // namespace elrom::field
