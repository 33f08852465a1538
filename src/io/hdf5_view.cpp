// One dataset seen as another shape.
#include "hdf5_internal.hpp"

namespace elrom::io {

using namespace detail;

void Hdf5Group::flat_view(const Hdf5Dataset& target, const std::string& name) const {
  const auto where = where_ + "/" + name;
  std::string path(static_cast<std::size_t>(std::max<ssize_t>(H5Iget_name(target.id(), nullptr, 0), 0)),
                   '\0');
  H5Iget_name(target.id(), path.data(), path.size() + 1);
  const Hdf5Id type(readable(H5Dget_type(target.id()), "cannot view dataset", target.where()));
  const Hdf5Id target_space(readable(H5Dget_space(target.id()), "cannot view dataset", target.where()));
  const auto n = static_cast<hsize_t>(H5Sget_simple_extent_npoints(target_space.get()));
  const Hdf5Id space(writable(H5Screate_simple(1, &n, nullptr), "cannot view dataset", where));
  const Hdf5Id list(writable(H5Pcreate(H5P_DATASET_CREATE), "cannot view dataset", where));
  H5Pset_obj_track_times(list.get(), false);
  // "." stands for the file itself, whatever it is called later on.
  writable(H5Pset_virtual(list.get(), space.get(), ".", path.c_str(), target_space.get()),
           "cannot view dataset", where);
  const Hdf5Id view(
      writable(H5Dcreate2(id(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT),
               "cannot view dataset", where));
}

}  // namespace elrom::io
