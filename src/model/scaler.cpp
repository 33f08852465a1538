#include "elrom/model/scaler.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"

namespace elrom::model {
namespace {

constexpr double deviation_limit = 10;
/// A spread below this share of the values' size is rounding, not variation.
constexpr double constant_share = 1e-6;

}  // namespace

InputScaler InputScaler::fit(const MatrixD& inputs, std::vector<double> relevance) {
  const auto n = static_cast<std::size_t>(inputs.cols());
  check(inputs.rows() > 0, "cases to learn the inputs' scale from");
  if (relevance.empty()) relevance.assign(n, 1.0);
  check(relevance.size() == n, "a relevance for every input");
  InputScaler scaler{std::vector<double>(n), std::vector<double>(n), std::move(relevance)};
  for (Eigen::Index k = 0; k < inputs.cols(); ++k) {
    const double mean = inputs.col(k).mean();
    const double deviation = std::sqrt((inputs.col(k).array() - mean).square().mean());
    const double size = inputs.col(k).cwiseAbs().maxCoeff();
    scaler.mean[static_cast<std::size_t>(k)] = mean;
    scaler.factor[static_cast<std::size_t>(k)] = deviation > constant_share * size ? 1 / deviation : 0;
  }
  return scaler;
}

void InputScaler::apply(std::span<const double> inputs, std::span<float> scaled) const {
  check(inputs.size() == size() && scaled.size() == size(), "as many inputs as were trained with");
  for (std::size_t k = 0; k < size(); ++k) {
    const double z = (inputs[k] - mean[k]) * factor[k];
    scaled[k] = static_cast<float>(relevance[k] * std::clamp(z, -deviation_limit, deviation_limit));
  }
}

OutputScaler OutputScaler::fit(const MatrixF& values, std::size_t n_columns, bool per_plane) {
  const auto columns = static_cast<Eigen::Index>(n_columns);
  check(values.rows() > 0 && columns > 0 && values.cols() % columns == 0, "whole planes of values");
  const Eigen::Index n_planes = values.cols() / columns, rows = per_plane ? n_planes : 1;
  const Eigen::Index group = n_planes / rows;  // planes that share one scale
  OutputScaler scaler{MatrixF(rows, columns), MatrixF(rows, columns)};
  Eigen::ArrayXd mean(columns), square(columns), largest(columns);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double n = static_cast<double>(values.rows() * group);
    const auto each = [&](auto&& use) {
      for (Eigen::Index i = 0; i < values.rows(); ++i)
        for (Eigen::Index plane = row * group; plane < (row + 1) * group; ++plane)
          use(values.row(i).segment(plane * columns, columns).transpose().array().cast<double>());
    };
    mean.setZero(), square.setZero(), largest.setZero();
    each([&](const auto& z) { mean += z, largest = largest.max(z.abs()); });
    mean /= n;
    each([&](const auto& z) { square += (z - mean).square(); });
    const Eigen::ArrayXd deviation = (square / n).sqrt();
    scaler.mean.row(row) = mean.cast<float>().transpose();
    scaler.deviation.row(row) =
        (deviation > constant_share * largest).select(deviation, 0.0).cast<float>().transpose();
  }
  return scaler;
}

}  // namespace elrom::model
