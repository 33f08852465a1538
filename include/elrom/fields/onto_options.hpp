#pragma once
// What the command line says of predictions on another mesh (--onto) and of the start of an OpenFOAM run.

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace elrom::fields {

/// How values get from the reduced mesh to another: means over parts of cells, or between centres.
enum class Interpolation { conservative, trilinear };

struct OntoOptions {
  std::filesystem::path mesh;  ///< an OpenFOAM case, or a file of cell centres; empty: the reduced mesh
  Interpolation interpolation = Interpolation::conservative;
  std::map<std::string, std::string> names;  ///< of fields in .ip files, where they are not the usual ones
  std::string time = "0";                    ///< name of the time folder
  std::optional<std::size_t> n_parcels;      ///< none: as many as the case's cloud has
  double parcel_spread = 0;                  ///< standard deviation of ln d over all parcels
  bool overwrite = false;                    ///< a time folder that is there
};

}  // namespace elrom::fields
