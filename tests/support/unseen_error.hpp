#pragma once
// How well a method predicts cases that it has not seen.

#include <cmath>

#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"

namespace elrom::test {

/// Error of cases left out, relative to predicting the mean.
inline double unseen_error(const methods::Method& method, const field::FieldData& data) {
  const auto rows = math::all_rows(data.cases->n_cases());
  const MatrixF predicted =
      method.cross_predict(data, methods::load_grouped_folds(data.cases->loads, rows, 6), {});
  const Eigen::VectorXd deviation = math::column_moments(data.values, rows).deviation;
  return std::sqrt((predicted - data.values).cast<double>().squaredNorm() /
                   (deviation.squaredNorm() * rows.size()));
}

}  // namespace elrom::test
