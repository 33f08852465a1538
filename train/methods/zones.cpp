#include "zones.hpp"

#include <algorithm>
#include <cmath>

namespace elrom::methods {

namespace {

/// Planes over which one zone fades into the next, as a share of the planes from middle to middle.
constexpr double fading = 0.25;

/// Of a plane in the zone about `middle`, with its neighbours' middles `reach` planes away.
double weight_of(std::size_t plane, double middle, double reach) {
  const double beyond = std::abs(static_cast<double>(plane) - middle) / reach - 0.5;
  return std::clamp(0.5 - beyond / fading, 0.0, 1.0);
}

}  // namespace

Eigen::MatrixXd Zone::gram(const MatrixF& a, const MatrixF& b) const {
  constexpr Eigen::Index block = 1024;
  const bool same = &a == &b;  // one triangle then gives the other
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(a.rows(), b.rows());
  for (Eigen::Index begin = 0; begin < weights.size(); begin += block) {
    const auto n = std::min(block, weights.size() - begin);
    const Eigen::RowVectorXd own = weights.segment(begin, n).cast<double>();
    const MatrixD left = a.middleCols(first_cell + begin, n).cast<double>();
    if (same)
      gram.selfadjointView<Eigen::Lower>().rankUpdate(MatrixD(left * own.cwiseSqrt().asDiagonal()));
    else
      gram += left * own.asDiagonal() * b.middleCols(first_cell + begin, n).cast<double>().transpose();
  }
  if (same) gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

void Zone::add(MatrixF& sum, const MatrixF& predicted) const {
  sum.middleCols(first_cell, weights.size()) += predicted * weights.asDiagonal();
}

std::vector<Zone> zones_of(const FundamentalDomain& domain, std::size_t n_zones) {
  const std::size_t n_planes = domain.n_planes();
  const auto n_columns = static_cast<Eigen::Index>(domain.n_columns());
  if (n_zones < 2 || n_planes < 2 * n_zones || !domain.keeps_planes()) {
    const auto n_cells = static_cast<Eigen::Index>(domain.n_cells());
    return {{.n_planes = n_planes, .weights = Eigen::RowVectorXf::Ones(n_cells)}};
  }
  const double reach = static_cast<double>(n_planes - 1) / static_cast<double>(n_zones - 1);
  std::vector<Zone> zones(n_zones);
  for (std::size_t k = 0; k < n_zones; ++k) {
    Zone& zone = zones[k];
    const double middle = static_cast<double>(k) * reach;
    while (weight_of(zone.first_plane, middle, reach) == 0) ++zone.first_plane;
    std::size_t end = zone.first_plane;
    while (end < n_planes && weight_of(end, middle, reach) > 0) ++end;
    zone.n_planes = end - zone.first_plane;
    zone.first_cell = static_cast<Eigen::Index>(zone.first_plane) * n_columns;
    zone.weights.resize(static_cast<Eigen::Index>(zone.n_planes) * n_columns);
    for (std::size_t plane = 0; plane < zone.n_planes; ++plane)
      zone.weights.segment(static_cast<Eigen::Index>(plane) * n_columns, n_columns)
          .setConstant(static_cast<float>(weight_of(zone.first_plane + plane, middle, reach)));
  }
  return zones;
}

}  // namespace elrom::methods
