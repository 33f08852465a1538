#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "case_entries.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "snapshot_layout.hpp"

namespace elrom::field {

namespace {

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
  Mesh mesh;
  InputSchema schema;
  std::vector<FieldInfo> fields;
  std::optional<Furnace> furnace;
  std::optional<base::FileLock> lock;  // nothing: who made this holds it
  std::unique_ptr<base::AtomicFile> target;
  std::optional<io::Hdf5File> file;
  std::vector<CaseRecord> cases;
  std::size_t n_old = 0;  // of `cases`

  void begin() {
    target = std::make_unique<base::AtomicFile>(path);
    cases.clear();
    if (std::filesystem::exists(path))
      continue_from_old();
    else
      start_new();
    describe();
    n_old = cases.size();
  }

  void describe() {
    if (!furnace) return;
    detail::write_furnace(*file, *furnace);
    io::write_kind(*file, io::kinds::snapshots);  // an older store may be continued
  }

  void start_new() {
    file = io::Hdf5File::create(target->temporary());
    io::write_kind(*file, io::kinds::snapshots);
    write_mesh(file->create_group("mesh"), mesh);
    detail::write_schema(*file, schema);
    detail::create_fields(*file, fields, mesh);
  }

  void continue_from_old() {
    {
      const auto old = SnapshotStore::open(path);
      expect_same_mesh(old, mesh);
      expect_same_schema(old, schema);
      expect_same_fields(old, fields);
      cases = old.cases();
    }
    std::filesystem::copy_file(path, target->temporary());
    file = io::Hdf5File::open(target->temporary(), io::Hdf5File::Access::edit);
  }

  void append(const CaseRecord& record, const MatrixF& values) {
    const auto i_case = cases.size();
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const auto dataset = file->dataset("fields/" + fields[f].name);
      dataset.extend(i_case + 1);
      const auto row = values.row(static_cast<Eigen::Index>(f));
      dataset.write_slab<float>({i_case, 0, 0}, {1, mesh.n_planes, mesh.n_columns},
                                {row.data(), static_cast<std::size_t>(row.size())});
    }
    cases.push_back(record);
  }

  void commit() {
    detail::write_cases(*file, cases, schema.size(), fields.size());
    file->close();
    target->commit();
  }

  [[nodiscard]] MatrixF fields_of(const io::Hdf5File& from, std::size_t i_case) const {
    MatrixF values(static_cast<Eigen::Index>(fields.size()), static_cast<Eigen::Index>(mesh.n_cells()));
    for (std::size_t f = 0; f < fields.size(); ++f) {
      auto row = values.row(static_cast<Eigen::Index>(f));
      from.dataset("fields/" + fields[f].name)
          .read_slab<float>({i_case, 0, 0}, {1, mesh.n_planes, mesh.n_columns}, {row.data(), mesh.n_cells()});
    }
    return values;
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
    check(snapshot.record.inputs.values.size() == schema.size(), "a case with the wrong number of inputs");
    check(snapshot.fields.rows() == static_cast<Eigen::Index>(fields.size()),
          "a case with the wrong number of fields");
    check(snapshot.fields.cols() == static_cast<Eigen::Index>(mesh.n_cells()), "a case on another mesh");
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
                               const std::vector<FieldInfo>& fields, const std::optional<Furnace>& furnace)
    : impl_(new Impl{path, mesh, schema, fields, furnace, {}, {}, {}, {}}) {
  impl_->lock.emplace(base::lock_beside(path));
  base::remove_remains(path);
  impl_->begin();
}

SnapshotWriter::~SnapshotWriter() = default;

void SnapshotWriter::add(const Snapshot& snapshot) {
  impl_->expect_complete(snapshot);
  auto record = snapshot.record;
  record.content_digest = content_digest(snapshot.fields);
  impl_->expect_new(record);
  impl_->append(record, snapshot.fields);
}

void SnapshotWriter::leave_out(const std::set<std::string>& names) {
  const auto before = std::exchange(impl_->target, nullptr);
  const auto cases = std::exchange(impl_->cases, {});
  const auto n_old = impl_->n_old;
  impl_->file->close();
  const auto file = io::Hdf5File::open(before->temporary());
  impl_->begin();
  for (std::size_t i = n_old; i < cases.size(); ++i)
    if (!names.contains(cases[i].inputs.name)) impl_->append(cases[i], impl_->fields_of(file, i));
}

void SnapshotWriter::commit() { impl_->commit(); }

void remove_cases(const std::filesystem::path& path, const std::set<std::string>& names) {
  const base::FileLock lock(base::lock_beside(path));
  base::remove_remains(path);
  const auto old = SnapshotStore::open(path);
  SnapshotWriter::Impl rest{path, old.mesh(), old.schema(), old.fields(), old.furnace(), std::nullopt, {},
                            {},   {}};
  rest.target = std::make_unique<base::AtomicFile>(path);
  rest.start_new();
  rest.describe();
  MatrixF values(static_cast<Eigen::Index>(rest.fields.size()),
                 static_cast<Eigen::Index>(rest.mesh.n_cells()));
  for (std::size_t i = 0; i < old.n_cases(); ++i) {
    if (names.contains(old.cases()[i].inputs.name)) continue;
    const std::size_t one[] = {i};
    for (std::size_t f = 0; f < rest.fields.size(); ++f)
      values.row(static_cast<Eigen::Index>(f)) = old.read(rest.fields[f].name, one);
    rest.append(old.cases()[i], values);
  }
  rest.commit();
}

}  // namespace elrom::field
