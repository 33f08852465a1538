#pragma once
// The screening as one writes it with LibTorch's modules: one network after another, with autograd and its
// Adam. What the batched screening is measured against, in time and in the bands it finds.

#include <cstdint>
#include <span>

#include "elrom/networks/screening.hpp"

namespace elrom::benchmark {

struct SequentialScreening {
  MatrixD build_error;  //!< mean squared error on the test records, (n_builds, columns.size())
  double seconds = 0;   ///< for all of them
  double mean_epochs = 0;

  /// Mean over builds, (columns.size()).
  [[nodiscard]] std::vector<double> column_error() const;
};

/// Starts every network at the weights, and visits the records in the order, of the batched screening of the
/// same seed.
/// @param columns a sample of the columns of `data`
[[nodiscard]] SequentialScreening screen_sequentially(const networks::ScreeningData& data,
                                                      const networks::ScreenSettings& settings,
                                                      base::Seed seed,
                                                      std::span<const std::uint32_t> columns);

}  // namespace elrom::benchmark
