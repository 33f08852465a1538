#pragma once
// The six instants of the shipped OpenFOAM case, one by one, and what an instant has that an average lacks.

#include <cmath>
#include <filesystem>
#include <vector>

#include "elrom/ingest/cfd_case.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::test {

/// (fields, cells) of solid velocity, gas velocity, pressure, diameter, volume fraction on the mesh of the
/// shipped EL3D exports.
struct ShippedInstants {
  ingest::CfdCase mean;
  std::vector<ingest::CfdCase> each;

  ShippedInstants() {
    namespace fs = std::filesystem;
    const fs::path whole = ELROM_SOURCE_DIR "/data/formats/instants/case";
    mean = ingest::read_openfoam(whole);
    for (const auto& time : fs::directory_iterator(whole)) {
      if (time.path().filename() == "constant") continue;
      const TemporaryFolder one;
      fs::create_directory_symlink(whole / "constant", one / "constant");
      fs::create_directory_symlink(time.path(), one / time.path().filename().string());
      each.push_back(ingest::read_openfoam(one.path()));
    }
  }
};

inline const ShippedInstants& shipped_instants() {
  static const ShippedInstants instants;
  return instants;
}

}  // namespace elrom::test
