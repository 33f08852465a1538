#include "shrinkage.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "elrom/base/parallel.hpp"

namespace elrom::methods {

namespace {

/// 0, 1, 2-3 as one band would be too coarse at the long end: index i falls into band floor(log2(i + 1)).
std::size_t octave(std::size_t i) { return static_cast<std::size_t>(std::bit_width(i + 1)) - 1; }

/// Of the whole axis of which this one may be half.
std::size_t whole_size(const Box& box, std::size_t axis) {
  return box.mirrored[axis] ? 2 * box.sizes[axis] : box.sizes[axis];
}
std::size_t whole_index(const Box& box, std::size_t axis, std::size_t k) {
  return !box.mirrored[axis] ? k : box.beyond[axis] == math::Beyond::same ? 2 * k : 2 * k + 1;
}

std::span<float> row_span(MatrixF& m, std::size_t i) {
  return {m.row(static_cast<Eigen::Index>(i)).data(), static_cast<std::size_t>(m.cols())};
}

}  // namespace

std::optional<Box> box_of(const field::Mesh& mesh) {
  if (static_cast<std::size_t>(mesh.centre.rows()) != mesh.n_cells() || mesh.n_columns == 0)
    return std::nullopt;
  const double extent = mesh.centre.col(1).maxCoeff() - mesh.centre.col(1).minCoeff();
  const auto y = [&](std::size_t column) { return mesh.centre(static_cast<Eigen::Index>(column), 1); };
  const auto same = [&](double a, double b) { return std::abs(a - b) <= 1e-6 * extent; };
  std::size_t n_x = 1;
  while (n_x < mesh.n_columns && same(y(n_x), y(0))) ++n_x;
  if (mesh.n_columns % n_x != 0) return std::nullopt;
  for (std::size_t c = 0; c < mesh.n_columns; ++c) {
    if (!same(y(c), y(c / n_x * n_x))) return std::nullopt;
  }
  return Box{{mesh.n_planes, mesh.n_columns / n_x, n_x}};
}

Shrinkage::Shrinkage(const std::optional<Box>& box) : box_(box) {
  if (!box) return;
  transform_.emplace(box->sizes, box->beyond);
  const auto [n_z, n_y, n_x] = box->sizes;
  const auto octaves = [&](std::size_t axis) { return octave(whole_size(*box, axis)) + 1; };
  const auto octave_of = [&](std::size_t axis, std::size_t k) { return octave(whole_index(*box, axis, k)); };
  n_bands_ = octaves(0) * octaves(1) * octaves(2);
  band_.reserve(n_z * n_y * n_x);
  for (std::size_t z = 0; z < n_z; ++z) {
    for (std::size_t y = 0; y < n_y; ++y) {
      for (std::size_t x = 0; x < n_x; ++x)
        band_.push_back((octave_of(0, z) * octaves(1) + octave_of(1, y)) * octaves(2) + octave_of(2, x));
    }
  }
}

void Shrinkage::learn(MatrixF& deviations, const MatrixF& truth, const Options& options, int n_threads) {
  if (!transform_) return;
  if (options.spectral) learn_bands(deviations, truth, options.prior, n_threads);
  learn_cells(deviations, truth, options.prior);
  deviations.array().rowwise() *= cellwise_.transpose().array();
}

void Shrinkage::apply(MatrixF& deviations, int n_threads) const {
  if (spectral_.size() != 0) apply_bands(deviations, n_threads);
  if (cellwise_.size() != 0) deviations.array().rowwise() *= cellwise_.transpose().array();
}

void Shrinkage::learn_bands(MatrixF& deviations, const MatrixF& truth, double prior, int n_threads) {
  const auto n = static_cast<std::size_t>(deviations.rows()),
             n_cells = static_cast<std::size_t>(deviations.cols());
  MatrixD products = MatrixD::Zero(deviations.rows(), static_cast<Eigen::Index>(n_bands_)),
          squares = products;
  base::parallel_for(n, n_threads, [&](std::size_t i, int) {
    const auto row = static_cast<Eigen::Index>(i);
    MatrixF true_row = truth.row(row);
    transform_->forward(row_span(deviations, i));
    transform_->forward(row_span(true_row, 0));
    for (std::size_t c = 0; c < n_cells; ++c) {
      const auto k = static_cast<Eigen::Index>(c), band = static_cast<Eigen::Index>(band_[c]);
      products(row, band) += static_cast<double>(deviations(row, k)) * true_row(0, k);
      squares(row, band) += static_cast<double>(deviations(row, k)) * deviations(row, k);
    }
  });
  const Eigen::VectorXd product = products.colwise().sum().transpose(),
                        square = squares.colwise().sum().transpose();
  const double trust = prior * square.mean() + 1e-300;
  const Eigen::VectorXd factor =
      ((product.array() + trust) / (square.array() + trust)).cwiseMax(0).cwiseMin(1);
  spectral_.resize(deviations.cols());
  for (std::size_t c = 0; c < n_cells; ++c) {
    spectral_[static_cast<Eigen::Index>(c)] = static_cast<float>(factor[static_cast<Eigen::Index>(band_[c])]);
  }
  scale_back(deviations, n_threads);
}

void Shrinkage::learn_cells(const MatrixF& deviations, const MatrixF& truth, double prior) {
  Eigen::VectorXd product = Eigen::VectorXd::Zero(deviations.cols()), square = product;
  for (Eigen::Index i = 0; i < deviations.rows(); ++i) {
    product.array() += deviations.row(i).transpose().cast<double>().array() *
                       truth.row(i).transpose().cast<double>().array();
    square += deviations.row(i).transpose().cast<double>().cwiseAbs2();
  }
  // About a sixth of the box each way: local enough to tell bed
  // from freeboard, wide enough to average the noise.
  std::array<std::size_t, 3> half{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    half[axis] = std::min<std::size_t>(whole_size(*box_, axis) / 12, 5);
  const double cells = static_cast<double>((2 * half[0] + 1) * (2 * half[1] + 1) * (2 * half[2] + 1));
  const double trust = prior * square.mean() * cells + 1e-300;
  cellwise_ = ((window_sums(product, *box_, half).array() + trust) /
               (window_sums(square, *box_, half).array() + trust))
                  .cwiseMax(0)
                  .cwiseMin(1.2)
                  .cast<float>();
}

void Shrinkage::scale_back(MatrixF& spectra, int n_threads) const {
  base::parallel_for(static_cast<std::size_t>(spectra.rows()), n_threads, [&](std::size_t i, int) {
    spectra.row(static_cast<Eigen::Index>(i)).array() *= spectral_.transpose().array();
    transform_->backward(row_span(spectra, i));
  });
}

void Shrinkage::apply_bands(MatrixF& deviations, int n_threads) const {
  base::parallel_for(static_cast<std::size_t>(deviations.rows()), n_threads,
                     [&](std::size_t i, int) { transform_->forward(row_span(deviations, i)); });
  scale_back(deviations, n_threads);
}

Eigen::VectorXd window_sums(const Eigen::VectorXd& values, const Box& box,
                            const std::array<std::size_t, 3>& half_widths) {
  Eigen::VectorXd now = values;
  const std::array<std::size_t, 3> stride{box.sizes[1] * box.sizes[2], box.sizes[2], 1};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd before = now;
    const auto n = static_cast<std::ptrdiff_t>(box.sizes[axis]),
               half = static_cast<std::ptrdiff_t>(half_widths[axis]);
    const auto inside = [&](std::ptrdiff_t at) {
      if (box.mirrored[axis] && at >= n) at = 2 * n - 1 - at;
      return std::clamp<std::ptrdiff_t>(at, 0, n - 1);
    };
    for (std::size_t c = 0; c < static_cast<std::size_t>(values.size()); ++c) {
      const auto at = static_cast<std::ptrdiff_t>(c / stride[axis] % box.sizes[axis]);
      double sum = 0;
      for (std::ptrdiff_t d = -half; d <= half; ++d)
        sum += before[static_cast<std::ptrdiff_t>(c) +
                      (inside(at + d) - at) * static_cast<std::ptrdiff_t>(stride[axis])];
      now[static_cast<Eigen::Index>(c)] = sum;
    }
  }
  return now;
}

}  // namespace elrom::methods
