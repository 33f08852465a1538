#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::ingest {
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

std::string kind_of(const std::filesystem::path& path) {
  std::string kind;
  const auto read = [&] {
    const auto file = io::Hdf5File::open(path);
    kind = file.has_attribute("kind") ? file.text("kind") : "";
  };
  io::survive(path, "kind", read);
  read();
  return kind;
}

bool is_snapshot_store(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path) || !is_hdf5(path)) return false;
  return kind_of(path) == io::kinds::snapshots.name;
}

CfdCase read_case(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) {
    if (std::filesystem::is_directory(path / "constant" / "polyMesh")) return read_openfoam(path);
    throw InputError({.what = "directory is no case",
                      .where = path.string(),
                      .expected = "an OpenFOAM case with constant/polyMesh"});
  }
  if (!is_hdf5(path)) return read_fluent_ascii(path);
  if (kind_of(path) == io::kinds::prediction.name) return read_simulation(path);
  io::survive(path, "case", [&] { (void)read_el3d(path); });
  return read_el3d(path);
}

std::string case_digest(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return base::sha256_file(path);
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  base::Sha256 hash;
  for (const auto& file : files)
    hash.add(file.lexically_relative(path).string()).add(base::sha256_file(file));
  return hash.hex();
}

}  // namespace elrom::ingest
