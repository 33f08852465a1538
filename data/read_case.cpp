#include <array>
#include <fstream>
#include <string_view>

#include "case_files.hpp"
#include "child_process.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::ingest {
namespace {

/// Malformed files find crashes in the HDF5 library itself; the child takes them first, over the same calls.
void survive_hdf5(const std::filesystem::path& path, const std::function<void()>& work) {
  std::error_code ignored;
  const auto bytes = std::filesystem::file_size(path, ignored);
  // Packed fields grow on reading; a gigabyte is enough for the library and for any small file.
  ChildLimits limits;
  limits.memory_bytes = (std::size_t{1} << 30) + 32 * static_cast<std::size_t>(ignored ? 0 : bytes);
  try_in_child("the HDF5 library", path.string(), work, limits);
}

}  // namespace

bool is_hdf5(const std::filesystem::path& path) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::array<char, 8> start{};
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError({.what = "cannot open file", .where = path.string()});
  file.read(start.data(), start.size());
  const auto ending = path.extension();
  return std::string_view(start.data(), start.size()) == signature || ending == ".h5" || ending == ".hdf5" ||
         ending == ".hdf";
}

bool is_snapshot_store(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path) || !is_hdf5(path)) return false;
  survive_hdf5(path, [&] { (void)io::Hdf5File::open(path).has_attribute("kind"); });
  const auto file = io::Hdf5File::open(path);
  return file.has_attribute("kind") && file.text("kind") == "elrom-snapshots";
}

CfdCase read_case(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) {
    if (std::filesystem::is_directory(path / "constant" / "polyMesh")) return read_openfoam(path);
    throw InputError({.what = "directory is no case",
                      .where = path.string(),
                      .expected = "an OpenFOAM case with constant/polyMesh"});
  }
  if (!is_hdf5(path)) return read_fluent_ascii(path);
  survive_hdf5(path, [&] { (void)read_el3d(path); });
  return read_el3d(path);
}

}  // namespace elrom::ingest
