#pragma once
// How well a default network can learn each column of a field: the error that banding sorts columns by.
//
// `networks` builds a one-hidden-layer network (relu) for every column, `builds` times, with Adam, the mean
// squared error and early stopping, many side by side (lane_network.hpp). `fast` answers the same question in
// closed form: ridge on random features, leaving one case out at a time.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/base/random.hpp"
#include "elrom/math/matrix.hpp"
#include "elrom/networks/settings.hpp"
#include "elrom/networks/split.hpp"

namespace elrom::networks {

/// Records of one field, standardised by the training records (eq. 6.1).
struct ScreeningData {
  MatrixF inputs;                     //!< (n_records, n_inputs)
  MatrixF targets;                    //!< (n_records, n_columns)
  std::vector<std::int32_t> plane;    //!< (n_records)
  std::vector<std::int32_t> case_of;  //!< (n_records)
  std::vector<Part> part;             //!< (n_records)
  std::size_t n_planes = 0;

  [[nodiscard]] std::vector<std::uint32_t> rows(Part wanted) const;
  /// Records that judge: those of Part::test, or, where there are none, of Part::validation.
  [[nodiscard]] std::vector<std::uint32_t> judging_rows() const;
};

struct ScreeningResult {
  //! Mean over builds of the mean squared error on a plane's test records, (n_planes, n_columns)
  MatrixD error;
  MatrixD build_error;  //!< mean squared error on all test records, (n_builds, n_columns); 1 row when fast
  double mean_epochs = 0;

  /// Mean over builds, (n_columns): what bands of scope `field` go by.
  [[nodiscard]] std::vector<double> column_error() const;
};

/// What a crew gives back for one of its columns.
struct ColumnOutcome {
  //! Sum of squared errors over the judging records of each plane, (n_planes)
  std::vector<double> plane_error;
  double error = 0;  //!< mean squared error over all judging records
  int epochs = 0;
};

/// Trains some columns of one build together (a crew): the unit that a screening is cut into.
using CrewTrainer = std::function<std::vector<ColumnOutcome>(
    std::size_t i_build, std::span<const std::uint32_t> columns, const std::stop_token& stop)>;
/// On the calling thread. The arguments must outlive what comes back. Thread rule: call it from any thread.
[[nodiscard]] CrewTrainer make_crew_trainer(const ScreeningData& data, const ScreenSettings& settings,
                                            base::Seed seed);

struct ScreeningContext {
  base::Seed seed{1};
  int n_threads = 1;
  Log* log = &silent_log();
  std::stop_token stop;
  std::string task = "screen";    ///< for progress
  CrewTrainer crew_trainer = {};  ///< empty: make_crew_trainer of the screening's own arguments
};

/// Divergence ends in a large finite error (largest_error), never in NaN. The same seed gives the same bits
/// for any number of threads. @throws Interrupted
[[nodiscard]] ScreeningResult screen_networks(const ScreeningData& data, const ScreenSettings& settings,
                                              const ScreeningContext& context);
inline constexpr double largest_error = 1e6;

/// Leave-one-case-out errors over all records; the ridge is chosen by them. @throws Interrupted
[[nodiscard]] ScreeningResult screen_fast(const ScreeningData& data, const ScreenSettings& settings,
                                          const ScreeningContext& context);

/// By settings.method.
[[nodiscard]] ScreeningResult screen(const ScreeningData& data, const ScreenSettings& settings,
                                     const ScreeningContext& context);

/// One column's network by itself.
struct ColumnNetwork {
  MatrixF hidden;             //!< weights and, last, bias of the hidden layer, (n_units, n_inputs + 1)
  std::vector<float> output;  //!< weights and, last, bias of the output, (n_units + 1)
};
/// Where build `i_build` of column `i_column` starts: uniform in +-1 / sqrt(fan-in), as LibTorch starts its
/// linear layers.
[[nodiscard]] ColumnNetwork initial_network(base::Seed seed, std::size_t i_build, std::size_t i_column,
                                            std::size_t n_inputs, std::size_t n_units);
/// Training records that one epoch of a build visits, in their order; batches are consecutive pieces, the
/// last one short. @param most_records ScreenSettings::epoch_records
[[nodiscard]] std::vector<std::uint32_t> epoch_order(base::Seed seed, std::size_t i_build,
                                                     std::size_t i_epoch, std::size_t n_train,
                                                     int most_records);

}  // namespace elrom::networks
