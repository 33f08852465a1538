#pragma once
// Storage order, stated once for the library: dense tables are row-major, one sample (case, record) a row;
// small square algebra uses Eigen's default (column-major) MatrixXd.

#include <Eigen/Core>

namespace elrom {

/// (rows, columns) float32, row-major: fields, records, weights.
using MatrixF = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// (rows, columns) float64, row-major: inputs, statistics.
using MatrixD = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMapF = Eigen::Map<const MatrixF>;
using MapF = Eigen::Map<MatrixF>;

}  // namespace elrom
