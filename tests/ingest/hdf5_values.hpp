#pragma once
// A second, independent way to read an EL3D export in tests: the HDF5 C interface, nothing of ELROM.

#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace elrom::ingest::testing {

inline std::vector<float> hdf5_values(const std::string& file, const std::string& dataset) {
  const hid_t f = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t d = f < 0 ? -1 : H5Dopen2(f, dataset.c_str(), H5P_DEFAULT);
  if (d < 0) throw std::runtime_error("test data missing: " + file + ":" + dataset);
  const hid_t space = H5Dget_space(d);
  std::vector<float> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  if (H5Dread(d, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) values.clear();
  H5Sclose(space);
  H5Dclose(d);
  H5Fclose(f);
  return values;
}

}  // namespace elrom::ingest::testing
