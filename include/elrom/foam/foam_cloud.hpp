#pragma once
// A Lagrangian cloud drawn from fields of solids, as a run of MPPICFoam (v1912) reads it on its start.
//
// Every parcel has the same mass: all solids over the number of parcels. Parcels are dealt out along the
// cells by systematic sampling, so a cell gets the number that its solids are worth, rounded up or down, and
// the cloud's mass is that of the field exactly. Places are uniform within the cell; diameter and velocity
// are the cell's. With a spread S of the whole cloud, that of ln D between cells is s0, and what is missing,
// s = sqrt(S^2 - s0^2), is spread within cells: D exp(s z - s^2 / 2), z standard normal within +-3,
// log-normal with the cell's D as the mean. Means are weighted by mass, as parcels weigh alike.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/foam/foam_cells.hpp"

namespace elrom::foam {

/// Of each cell, SI, (n_cells).
struct SolidFields {
  std::span<const float> volume_fraction, diameter, velocity_x, velocity_y, velocity_z;
};

struct CloudSettings {
  std::size_t n_parcels = 10000;
  double density = 0;  ///< of the material [kg/m3]
  double spread = 0;   ///< standard deviation of ln d over all parcels; where cells differ more, theirs stays
};

struct Parcel {
  std::size_t cell, face, point;  ///< its tetrahedron (foam_cells.hpp)
  Eigen::Vector4d weights;        ///< of the tetrahedron's corners
  Eigen::Vector3d position;       ///< [m]
  Eigen::Vector3d velocity;       ///< [m/s]
  double diameter;                ///< [m]
  double count;                   ///< real particles that it stands for
};

/// @return parcels by cell; none where the fields hold no solids @throws InputError for solids without a
/// diameter
[[nodiscard]] std::vector<Parcel> draw_cloud(const FoamMesh& mesh, const SolidFields& fields,
                                             const CloudSettings& settings, base::Seed seed);

/// Files of a cloud's folder (made when missing), ascii: what v1912 asks for and, as `positions`, what
/// ParaView and older versions do. @param time name of the time folder @param note for the files' headers
/// @throws SystemError
void write_cloud(const std::filesystem::path& folder, const std::vector<Parcel>& parcels, double density,
                 const std::string& time, const std::string& note);

}  // namespace elrom::foam
