#pragma once
// A crew: some columns of one build of the screening, trained together with their own early stopping.
// Finished networks are compacted away, so that they stop costing. Internal to the screening.

#include <stop_token>

#include "elrom/study/screening.hpp"
#include "lane_network.hpp"

namespace elrom::study {

/// What all crews of a field share, laid out once.
struct ScreeningTables {
  ScreeningTables(const ScreeningData& data, const ScreenSettings& settings, base::Seed seed);

  const ScreeningData& data;
  const ScreenSettings& settings;
  base::Seed seed;
  LaneShape shape;
  std::vector<std::uint32_t> train, validation, judging;
  MatrixF validation_inputs, judging_inputs;  //!< padded, (rows, shape.k)
};

/// What a crew gives back for one of its columns.
struct ColumnOutcome {
  std::vector<double>
      plane_error;   //!< sum of squared errors over the judging records of each plane, (n_planes)
  double error = 0;  //!< mean squared error over all judging records
  int epochs = 0;
};

/// @throws Interrupted
[[nodiscard]] std::vector<ColumnOutcome> train_crew(const ScreeningTables& tables, std::size_t i_build,
                                                    std::span<const std::uint32_t> columns,
                                                    const std::stop_token& stop);

}  // namespace elrom::study
