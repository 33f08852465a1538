#include "gradient.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <nanoflann.hpp>

namespace elrom::ingest {

namespace {

struct Cloud {
  const MatrixD& centre;
  [[nodiscard]] std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(centre.rows()); }
  [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t d) const {
    return centre(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d));
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Index =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>;

// Directions of the neighbours as seen from the cell: sum of d d^T / |d|^2, which is the normal matrix of the
// weighted fit and has no unit, so that its eigenvalues tell how well the directions span space.
Eigen::Matrix3d spread(const CellCloud& cloud, std::size_t cell,
                       const std::vector<std::int32_t>& neighbours) {
  const auto x = cloud.at(cell);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto n : neighbours) {
    const auto y = cloud.at(static_cast<std::size_t>(n));
    const Eigen::Vector3d d(y[0] - x[0], y[1] - x[1], y[2] - x[2]);
    const double square = d.squaredNorm();
    if (square > 0) sum += d * d.transpose() / square;
  }
  return sum;
}

Eigen::Matrix3d pseudo_inverse(const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>& solver) {
  constexpr double no_direction = 1e-6;
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  const double largest = solver.eigenvalues()[2];
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double value = solver.eigenvalues()[i];
    if (value > no_direction * largest && value > 0) {
      inverse += solver.eigenvectors().col(i) * solver.eigenvectors().col(i).transpose() / value;
    }
  }
  return inverse;
}

}  // namespace

struct CellCloud::Tree {
  explicit Tree(const MatrixD& centre)
      : cloud{centre}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}
  Cloud cloud;
  Index index;
};

CellCloud::CellCloud(const MatrixD& centre) : centre_(centre), tree_(std::make_unique<Tree>(centre)) {}
CellCloud::~CellCloud() = default;

Point CellCloud::at(std::size_t cell) const {
  const auto row = static_cast<Eigen::Index>(cell);
  return {centre_(row, 0), centre_(row, 1), centre_(row, 2)};
}

std::vector<std::int32_t> CellCloud::nearest(const Point& x, std::size_t k) const {
  constexpr double tie = 1e-4;  // of the squared distance: exports keep centres as float32
  k = std::min(k, size());
  std::vector<std::uint32_t> cells;
  std::vector<double> squares;
  for (std::size_t asked = std::min(size(), k + std::min<std::size_t>(k, 24));;
       asked = std::min(size(), 2 * asked)) {
    cells.resize(asked);
    squares.resize(asked);
    tree_->index.knnSearch(x.data(), asked, cells.data(), squares.data());
    if (asked == size() || squares.back() > squares[k - 1] * (1 + tie)) break;
  }
  const auto end = std::upper_bound(squares.begin(), squares.end(), squares[k - 1] * (1 + tie));
  const auto n = static_cast<std::size_t>(end - squares.begin());
  return std::vector<std::int32_t>(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(n));
}

Gradient CellCloud::gradient(std::size_t cell) const {
  constexpr std::size_t fewest = 18, most = 200;
  constexpr double well_spread = 0.05;
  const auto x = at(cell);
  std::vector<std::int32_t> neighbours;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  for (std::size_t k = fewest + 1;; k *= 2) {
    neighbours = nearest(x, k);
    solver.compute(spread(*this, cell, neighbours));
    const auto& values = solver.eigenvalues();
    if (values[0] >= well_spread * values[2] || k >= most || neighbours.size() == size()) break;
  }
  const Eigen::Matrix3d inverse = pseudo_inverse(solver);
  Gradient gradient;
  Point own{};
  for (const auto n : neighbours) {
    const auto y = at(static_cast<std::size_t>(n));
    const Eigen::Vector3d d(y[0] - x[0], y[1] - x[1], y[2] - x[2]);
    const double square = d.squaredNorm();
    if (!(square > 0)) continue;
    const Eigen::Vector3d c = inverse * d / square;
    gradient.entries.push_back({n, {c[0], c[1], c[2]}});
    for (std::size_t i = 0; i < 3; ++i) own[i] -= c[static_cast<Eigen::Index>(i)];
  }
  gradient.entries.push_back({static_cast<std::int32_t>(cell), own});
  return gradient;
}

}  // namespace elrom::ingest
