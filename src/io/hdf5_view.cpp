// One dataset seen as another shape.
#include <array>

#include "elrom/io/vtkhdf.hpp"
#include "hdf5_internal.hpp"

namespace elrom::io {

using namespace detail;

namespace {

std::string path_of(const Hdf5Dataset& dataset) {
  const auto length = H5Iget_name(dataset.id(), nullptr, 0);
  std::string path(static_cast<std::size_t>(std::max<ssize_t>(length, 0)), '\0');
  H5Iget_name(dataset.id(), path.data(), path.size() + 1);
  return path;
}

Hdf5Id space_of(const Hdf5Dataset& dataset) {
  return Hdf5Id(readable(H5Dget_space(dataset.id()), "cannot view dataset", dataset.where()));
}

/// The values of one dataset as a row, of several as the columns of a table.
void view(const Hdf5Group& group, std::span<const Hdf5Dataset* const> targets, const std::string& name) {
  const auto where = group.where() + "/" + name;
  const auto made = [&](auto result) { return writable(result, "cannot view dataset", where); };
  const auto& first = *targets.front();
  const Hdf5Id type(readable(H5Dget_type(first.id()), "cannot view dataset", first.where()));
  const std::array<hsize_t, 2> size{static_cast<hsize_t>(H5Sget_simple_extent_npoints(space_of(first).get())),
                                    targets.size()};
  const Hdf5Id space(made(H5Screate_simple(targets.size() > 1 ? 2 : 1, size.data(), nullptr)));
  const Hdf5Id list(made(H5Pcreate(H5P_DATASET_CREATE)));
  H5Pset_obj_track_times(list.get(), false);
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const std::array<hsize_t, 2> start{0, i}, count{size[0], 1};
    if (targets.size() > 1)
      made(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
    // "." stands for the file itself, whatever it is called later on.
    made(H5Pset_virtual(list.get(), space.get(), ".", path_of(*targets[i]).c_str(),
                        space_of(*targets[i]).get()));
  }
  H5Sselect_all(space.get());
  const Hdf5Id dataset(made(
      H5Dcreate2(group.id(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT)));
}

}  // namespace

void Hdf5Group::flat_view(const Hdf5Dataset& target, const std::string& name) const {
  view(*this, std::array{&target}, name);
}

void show_cell_vectors(const Hdf5Group& cell_data, std::span<const Hdf5Dataset> components,
                       const std::string& name) {
  std::vector<const Hdf5Dataset*> targets;
  for (const auto& component : components) targets.push_back(&component);
  view(cell_data, targets, name);
}

}  // namespace elrom::io
