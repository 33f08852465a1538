#pragma once
// The gas that spheres meet: at rest or in uniform motion, or a frozen field. One seam.
//
// Thread rule: const use from any thread.

#include <filesystem>
#include <memory>
#include <span>

#include "elrom/math/matrix.hpp"
#include "elrom/particle/drag.hpp"
#include "elrom/scene/particles.hpp"

namespace elrom::scene {

class GasField {
 public:
  virtual ~GasField() = default;
  /// Velocity of the gas, m/s, where the spheres [first, first + size) are.
  virtual void velocity(const Vectors& place, std::size_t first, std::span<Vec> velocities) const = 0;
  [[nodiscard]] virtual std::size_t bytes() const { return 0; }
};

[[nodiscard]] std::unique_ptr<GasField> uniform_gas(const Vec& velocity);

/// A field given at scattered centres (cells of a mesh), resampled onto a regular grid as fine as the
/// centres are dense, and trilinear between its points. Outside of the centres' box: as at its nearest side.
/// @param centres (n, 3), m @param velocities (n, 3), m/s @throws InputError for none, or values that are
/// not finite
[[nodiscard]] std::unique_ptr<GasField> frozen_gas(const MatrixD& centres, const MatrixD& velocities,
                                                   int n_threads);
/// The gas velocities of a prediction (elrom-predict, .hdf). @throws InputError
[[nodiscard]] std::unique_ptr<GasField> frozen_gas(const std::filesystem::path& prediction, int n_threads);

}  // namespace elrom::scene
