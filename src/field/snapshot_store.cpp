#include "elrom/field/snapshot_store.hpp"

#include <algorithm>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "snapshot_layout.hpp"

namespace elrom::field {

struct SnapshotStore::Impl {
  std::filesystem::path path;
  io::Hdf5File file;
  Mesh mesh;
  InputSchema schema;
  std::optional<Furnace> furnace;
  std::vector<FieldInfo> fields;
  std::vector<CaseRecord> cases;
};

SnapshotStore::SnapshotStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SnapshotStore::SnapshotStore(SnapshotStore&&) noexcept = default;
SnapshotStore& SnapshotStore::operator=(SnapshotStore&&) noexcept = default;
SnapshotStore::~SnapshotStore() = default;

SnapshotStore SnapshotStore::open(const std::filesystem::path& path) {
  io::survive(path, "store", [&] {
    const auto store = open_here(path);
    for (std::size_t i = 0; i < store.n_cases(); ++i) {  // one at a time: stores are larger than memory
      for (const auto& field : store.fields()) static_cast<void>(store.read(field.name, {&i, 1}));
    }
  });
  return open_here(path);
}

SnapshotStore SnapshotStore::open_here(const std::filesystem::path& path) {
  auto file = io::Hdf5File::open(path);
  io::check_kind(file, io::kinds::snapshots);
  auto impl = std::make_unique<Impl>(Impl{.path = path, .file = std::move(file)});
  impl->mesh = read_mesh(impl->file.group("mesh"));
  impl->schema = detail::read_schema(impl->file);
  impl->furnace = detail::read_furnace(impl->file);
  impl->fields = detail::read_fields(impl->file);
  if (impl->furnace) impl->fields = impl->furnace->limited(std::move(impl->fields));
  impl->cases = detail::read_cases(impl->file, impl->schema.size(), impl->fields.size());
  const io::Shape shape{impl->cases.size(), impl->mesh.n_planes, impl->mesh.n_columns};
  for (const auto& field : impl->fields) impl->file.dataset("fields/" + field.name).expect_shape(shape);
  return SnapshotStore(std::move(impl));
}

std::size_t SnapshotStore::n_cases() const { return impl_->cases.size(); }
const Mesh& SnapshotStore::mesh() const { return impl_->mesh; }
const InputSchema& SnapshotStore::schema() const { return impl_->schema; }
const std::optional<Furnace>& SnapshotStore::furnace() const { return impl_->furnace; }
const std::vector<FieldInfo>& SnapshotStore::fields() const { return impl_->fields; }
const std::vector<CaseRecord>& SnapshotStore::cases() const { return impl_->cases; }
const std::filesystem::path& SnapshotStore::path() const { return impl_->path; }

std::vector<std::size_t> SnapshotStore::find(std::string_view pattern) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < impl_->cases.size(); ++i) {
    if (base::matches(impl_->cases[i].inputs.name, pattern)) found.push_back(i);
  }
  return found;
}

MatrixD SnapshotStore::inputs(std::span<const std::size_t> cases) const {
  MatrixD table(static_cast<Eigen::Index>(cases.size()), static_cast<Eigen::Index>(impl_->schema.size()));
  for (std::size_t row = 0; row < cases.size(); ++row) {
    check(cases[row] < n_cases(), "no such case in the store");
    const auto& values = impl_->cases[cases[row]].inputs.values;
    std::copy(values.begin(), values.end(), table.row(static_cast<Eigen::Index>(row)).data());
  }
  return table;
}

MatrixF SnapshotStore::read(std::string_view field, std::span<const std::size_t> cases) const {
  const auto& mesh = impl_->mesh;
  if (std::ranges::find(impl_->fields, field, &FieldInfo::name) == impl_->fields.end())
    throw InputError(unknown_field(impl_->fields, field, path().string()));
  const auto dataset = impl_->file.dataset("fields/" + std::string(field));
  MatrixF values(static_cast<Eigen::Index>(cases.size()), static_cast<Eigen::Index>(mesh.n_cells()));
  for (std::size_t row = 0; row < cases.size(); ++row) {
    check(cases[row] < n_cases(), "no such case in the store");
    dataset.read_slab<float>({cases[row], 0, 0}, {1, mesh.n_planes, mesh.n_columns},
                             {values.row(static_cast<Eigen::Index>(row)).data(), mesh.n_cells()});
  }
  return values;
}

std::string SnapshotStore::digest(std::span<const std::size_t> cases) const {
  base::Sha256 hash;
  hash.add(io::kinds::snapshots.name).add(std::string_view(impl_->mesh.digest()));
  for (const auto& input : impl_->schema.inputs())
    hash.add(std::string_view(input.name)).add(std::string_view(input.unit));
  for (const auto& field : impl_->fields)
    hash.add(std::string_view(field.name)).add(std::string_view(field.unit));
  for (const auto i : cases) {
    check(i < n_cases(), "no such case in the store");
    const auto& one = impl_->cases[i];
    hash.add(std::string_view(one.inputs.name)).add_value(one.inputs.load);
    hash.add(std::as_bytes(std::span(one.inputs.values))).add(std::string_view(one.content_digest));
  }
  return hash.hex();
}

}  // namespace elrom::field
