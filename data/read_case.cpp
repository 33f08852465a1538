#include <array>
#include <fstream>
#include <string_view>

#include "elrom/base/error.hpp"
#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {
namespace {

bool is_hdf5(const std::filesystem::path& path) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::array<char, 8> start{};
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError({.what = "cannot open file", .where = path.string()});
  file.read(start.data(), start.size());
  // A damaged HDF5 file is better reported by the HDF5 reader than as a strange text.
  const auto ending = path.extension();
  return std::string_view(start.data(), start.size()) == signature || ending == ".h5" || ending == ".hdf5" ||
         ending == ".hdf";
}

}  // namespace

CfdCase read_case(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) {
    if (std::filesystem::is_directory(path / "constant" / "polyMesh")) return read_openfoam(path);
    throw InputError({.what = "directory is no case",
                      .where = path.string(),
                      .expected = "an OpenFOAM case with constant/polyMesh"});
  }
  return is_hdf5(path) ? read_el3d(path) : read_fluent_ascii(path);
}

}  // namespace elrom::ingest
