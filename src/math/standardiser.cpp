#include "elrom/math/standardiser.hpp"

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::math {

Standardiser::Standardiser(const MatrixD& training_rows) {
  ColumnMoments moments = column_moments(training_rows);
  mean_ = std::move(moments.mean);
  scale_ = std::move(moments.deviation);
  constexpr double constant = 1e-12;  // rounding of equal values leaves about 1e-16 of their size
  for (Eigen::Index j = 0; j < scale_.size(); ++j) {
    if (!(scale_[j] > constant * std::abs(mean_[j]))) scale_[j] = 1;
  }
}

Standardiser::Standardiser(Eigen::VectorXd mean, Eigen::VectorXd scale)
    : mean_(std::move(mean)), scale_(std::move(scale)) {
  check(mean_.size() == scale_.size(), "standardiser: mean and scale of one size");
}

MatrixD Standardiser::apply(const MatrixD& rows) const {
  check(rows.cols() == size(), "standardiser: number of columns");
  return (rows.rowwise() - mean_.transpose()).array().rowwise() / scale_.transpose().array();
}

MatrixD Standardiser::undo(const MatrixD& rows) const {
  check(rows.cols() == size(), "standardiser: number of columns");
  return (rows.array().rowwise() * scale_.transpose().array()).matrix().rowwise() + mean_.transpose();
}

void Standardiser::apply(std::span<const double> row, std::span<double> out) const {
  check(row.size() == out.size() && static_cast<Eigen::Index>(row.size()) == size(),
        "standardiser: row size");
  for (std::size_t j = 0; j < row.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    out[j] = (row[j] - mean_[k]) / scale_[k];
  }
}

}  // namespace elrom::math
