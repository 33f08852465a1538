#pragma once
// Standardisation of a network's inputs and targets (source: eq. 6.1), fitted on training cases only.
// Thread rule: const use from any thread.

#include <cstddef>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::model {

/// x_scaled = relevance (x - mean) / deviation (source: eq. 6.1; relevance is ours, 1 = as in the source).
/// The middle part is kept inside +-10 deviations, which no training case of a few hundred leaves: far
/// outside, the fields stay bounded. An input that was constant in training has no influence.
struct InputScaler {
  std::vector<double> mean;       //!< SI, (n_inputs)
  std::vector<double> factor;     //!< 1 / deviation, 0 for a constant input, (n_inputs)
  std::vector<double> relevance;  //!< (n_inputs)

  /// @param inputs training cases, SI, (n_cases, n_inputs) @param relevance empty: all 1
  [[nodiscard]] static InputScaler fit(const MatrixD& inputs, std::vector<double> relevance = {});
  [[nodiscard]] std::size_t size() const { return mean.size(); }
  void apply(std::span<const double> inputs, std::span<float> scaled) const;
};

/// z_scaled = (z - mean) / deviation on transformed values, per column, or per plane and column.
struct OutputScaler {
  MatrixF mean,
      deviation;  //!< in the transformed unit, (1 or n_planes, n_columns); deviation 0: constant in training

  /// @param values transformed training values, (n_cases,
  /// n_planes * n_columns) @param per_plane one scale a cell
  [[nodiscard]] static OutputScaler fit(const MatrixF& values, std::size_t n_columns, bool per_plane);
  [[nodiscard]] Eigen::Index row(std::size_t plane) const {
    return mean.rows() == 1 ? 0 : static_cast<Eigen::Index>(plane);
  }
};

}  // namespace elrom::model
