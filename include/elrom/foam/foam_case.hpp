#pragma once
// A case of OpenFOAM into which a run's start is to be written: what it calls things, and a time folder made
// from one that it has.
//
// Non-goals: cases that are decomposed, binary files, #include in fields.

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "elrom/foam/foam_cloud.hpp"

namespace elrom::foam {

struct FoamCase {
  std::filesystem::path directory;
  std::filesystem::path fields;       ///< its latest time folder that holds the gas velocity
  std::string gas;                    ///< "air": fields are U.air, alpha.air; empty: U, and no alpha
  std::optional<double> gas_density;  ///< [kg/m3], where p is kinematic; none: p is in Pa
  std::string cloud;                  ///< of the solids; empty: the case has none
  std::optional<double> solid_density;
  std::optional<std::size_t> n_parcels;  ///< of the cloud in `fields`, where it has one

  [[nodiscard]] std::string with_gas(const std::string& name) const {
    return gas.empty() ? name : name + "." + gas;
  }
};

/// Reads how the case is made. @throws InputError naming the file: no such folder, no time folder with a gas
/// velocity, p in another unit or kinematic without a density of the gas
[[nodiscard]] FoamCase read_foam_case(const std::filesystem::path& directory);

/// Of each cell, SI, (n_cells).
struct StartFields {
  std::span<const float> gas_velocity_x, gas_velocity_y, gas_velocity_z;
  std::span<const float> pressure;  ///< [Pa], gauge
  SolidFields solids;
};

/// Writes the time folder `target`: U, p and, of a case with solids, alpha and the cloud. Boundary conditions
/// and all other fields of cells (k, epsilon ...) are those of `of.fields`; fluxes are left out, as they
/// belong to another velocity. The folder appears whole; one that is there is replaced.
/// @param note for the headers @throws SystemError, InputError
void write_time_folder(const FoamCase& of, const std::filesystem::path& target, const StartFields& start,
                       const std::vector<Parcel>& parcels, double solid_density, const std::string& note);

}  // namespace elrom::foam
