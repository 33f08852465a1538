#include "interpolation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <nanoflann.hpp>
#include <numeric>
#include <optional>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::fields {
namespace {

using Eigen::Vector3d;

/// Cells by the distance of their centres.
class Nearest {
 public:
  explicit Nearest(const MatrixD& centre)
      : cloud_{centre}, index_(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}

  /// The k nearest, nearest first; fewer where there are fewer.
  [[nodiscard]] std::vector<std::uint32_t> find(const Vector3d& x, std::size_t k) const {
    std::vector<std::uint32_t> cells(k);
    std::vector<double> distances(k);
    cells.resize(index_.knnSearch(x.data(), k, cells.data(), distances.data()));
    return cells;
  }

 private:
  struct Cloud {
    const MatrixD& centre;
    [[nodiscard]] std::size_t kdtree_get_point_count() const {
      return static_cast<std::size_t>(centre.rows());
    }
    [[nodiscard]] double kdtree_get_pt(std::size_t i, std::size_t d) const {
      return centre(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d));
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t>
      index_;
};

/// How many neighbours by centre may hold a point: a cell's own and those around a corner.
constexpr std::size_t n_candidates = 8;

/// A hexahedron of eight corners in VTK's order, with coordinates u in the unit cube.
class Hexahedron {
 public:
  Hexahedron(const field::Mesh& mesh, std::size_t cell) {
    for (int i = 0; i < 8; ++i)
      corners_.col(i) = mesh.points.row(mesh.corners[8 * cell + static_cast<std::size_t>(i)]).transpose();
  }
  /// Of the corners at u.
  [[nodiscard]] static Eigen::Matrix<double, 8, 1> weights(const Vector3d& u) {
    Eigen::Matrix<double, 8, 1> result;
    for (int i = 0; i < 8; ++i) result[i] = factor(i, 0, u) * factor(i, 1, u) * factor(i, 2, u);
    return result;
  }
  [[nodiscard]] Vector3d at(const Vector3d& u) const { return corners_ * weights(u); }
  [[nodiscard]] Eigen::Matrix3d jacobian(const Vector3d& u) const {
    Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 8; ++i) {
      for (int d = 0; d < 3; ++d) {
        const int e = (d + 1) % 3, f = (d + 2) % 3;
        result.col(d) += corners_.col(i) * ((is_far(i, d) ? 1 : -1) * factor(i, e, u) * factor(i, f, u));
      }
    }
    return result;
  }
  /// Where x lies, by Newton's method; nothing: outside.
  [[nodiscard]] std::optional<Vector3d> find(const Vector3d& x) const {
    constexpr double tolerance = 1e-6;
    constexpr int most_steps = 12;
    Vector3d u = Vector3d::Constant(0.5);
    for (int step = 0; step < most_steps; ++step) {
      const Vector3d change = jacobian(u).partialPivLu().solve(x - at(u));
      if (!change.allFinite()) return std::nullopt;
      u += change;
      if (change.cwiseAbs().maxCoeff() < tolerance) break;
    }
    const bool inside = (u.array() >= -tolerance).all() && (u.array() <= 1 + tolerance).all();
    return inside ? std::optional<Vector3d>(u.cwiseMax(0).cwiseMin(1)) : std::nullopt;
  }

 private:
  /// Whether corner i lies at 1 along axis d: VTK goes around each face.
  static bool is_far(int i, int d) {
    return d == 2 ? i >= 4 : d == 1 ? i % 4 >= 2 : (i % 4 == 1 || i % 4 == 2);
  }
  static double factor(int i, int d, const Vector3d& u) { return is_far(i, d) ? u[d] : 1 - u[d]; }

  Eigen::Matrix<double, 3, 8> corners_;
};

Vector3d row_of(const MatrixD& centre, std::size_t i) {
  return centre.row(static_cast<Eigen::Index>(i)).transpose();
}

/// The cell of a mesh that a point lies in, and where in it.
class Cells {
 public:
  explicit Cells(const field::Mesh& mesh) : mesh_(mesh), centres_(mesh.centre) {}
  struct Place {
    std::size_t cell;
    Vector3d u;
  };
  [[nodiscard]] std::optional<Place> find(const Vector3d& x) const {
    for (const auto cell : centres_.find(x, n_candidates))
      if (const auto u = Hexahedron(mesh_, cell).find(x)) return Place{cell, *u};
    return std::nullopt;
  }

 private:
  const field::Mesh& mesh_;
  Nearest centres_;
};

/// What points of the source belong to: the target that they lie in, or where targets have no faces the one
/// with the nearest centre, of those that lie in the source themselves.
class Owners {
 public:
  Owners(const field::Mesh& from, const Places& to, int n_threads)
      : to_(to),
        inside_(to.contains ? all_of(to) : inside(from, to, n_threads)),
        centre_(rows_of(to)),
        nearest_(centre_) {}

  /// -1: none
  [[nodiscard]] std::int32_t find(const Vector3d& x) const {
    for (const auto i : nearest_.find(x, to_.contains ? n_candidates : 1))
      if (!to_.contains || to_.contains(inside_[i], x)) return static_cast<std::int32_t>(inside_[i]);
    return -1;
  }

 private:
  static std::vector<std::size_t> all_of(const Places& to) {
    std::vector<std::size_t> all(static_cast<std::size_t>(to.centre.rows()));
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  }
  static std::vector<std::size_t> inside(const field::Mesh& from, const Places& to, int n_threads) {
    const Cells cells(from);
    auto targets = all_of(to);
    std::vector<char> is_inside(targets.size());
    base::parallel_for(targets.size(), n_threads, [&](std::size_t i, int) {
      is_inside[i] = cells.find(row_of(to.centre, i)).has_value() ? 1 : 0;
    });
    std::erase_if(targets, [&](std::size_t i) { return is_inside[i] == 0; });
    return targets;
  }
  [[nodiscard]] MatrixD rows_of(const Places& to) const {
    MatrixD rows(static_cast<Eigen::Index>(inside_.size()), 3);
    for (std::size_t i = 0; i < inside_.size(); ++i)
      rows.row(static_cast<Eigen::Index>(i)) = row_of(to.centre, inside_[i]).transpose();
    return rows;
  }

  const Places& to_;
  std::vector<std::size_t> inside_;  //!< targets that can own a point
  MatrixD centre_;                   //!< of those
  Nearest nearest_;
};

}  // namespace

Interpolator::Interpolator(const field::Mesh& from, const Places& to, Interpolation how, int n_threads) {
  check(from.corners.size() == 8 * from.n_cells(), "interpolation: a mesh with its corners");
  how == Interpolation::conservative ? conservative(from, to, n_threads) : trilinear(from, to, n_threads);
}

void Interpolator::conservative(const field::Mesh& from, const Places& to, int n_threads) {
  const auto n_source = from.n_cells();
  const auto n_target = static_cast<std::size_t>(to.centre.rows());
  // At least eight parts for each target, were they spread evenly.
  const double wanted = std::cbrt(8.0 * static_cast<double>(n_target) / static_cast<double>(n_source));
  const auto k = std::clamp<std::size_t>(static_cast<std::size_t>(std::ceil(wanted)), 2, 8);
  const Owners owners(from, to, n_threads);
  std::vector<std::vector<Entry>> parts(n_source);  // target and volume
  base::parallel_for(n_source, n_threads, [&](std::size_t cell, int) {
    const Hexahedron hexahedron(from, cell);
    double sum = 0;
    for (std::size_t part = 0; part < k * k * k; ++part) {
      const Vector3d u = (Vector3d(static_cast<double>(part % k), static_cast<double>(part / k % k),
                                   static_cast<double>(part / k / k))
                              .array() +
                          0.5) /
                         static_cast<double>(k);
      const double share = std::abs(hexahedron.jacobian(u).determinant());
      sum += share;
      parts[cell].push_back({owners.find(hexahedron.at(u)), static_cast<float>(share)});
    }
    for (auto& part : parts[cell]) part.weight *= static_cast<float>(from.volume[cell] / sum);
  });
  std::vector<std::vector<Entry>> rows(n_target);
  for (std::size_t cell = 0; cell < n_source; ++cell) {
    for (const auto& part : parts[cell]) {
      if (part.cell < 0) continue;
      auto& row = rows[static_cast<std::size_t>(part.cell)];
      const auto source = static_cast<std::int32_t>(cell);
      if (!row.empty() && row.back().cell == source) {
        row.back().weight += part.weight;
      } else {
        row.push_back({source, part.weight});
      }
    }
  }
  take_nearest(from, to, rows);
}

void Interpolator::trilinear(const field::Mesh& from, const Places& to, int n_threads) {
  std::vector<std::vector<std::int32_t>> around(static_cast<std::size_t>(from.points.rows()));
  std::vector<double> volume(around.size(), 0);
  for (std::size_t i = 0; i < from.corners.size(); ++i) {
    const auto point = static_cast<std::size_t>(from.corners[i]);
    around[point].push_back(static_cast<std::int32_t>(i / 8));
    volume[point] += from.volume[i / 8];
  }
  const Cells cells(from);
  std::vector<std::vector<Entry>> rows(static_cast<std::size_t>(to.centre.rows()));
  base::parallel_for(rows.size(), n_threads, [&](std::size_t target, int) {
    const auto place = cells.find(row_of(to.centre, target));
    if (!place) return;
    const auto weights = Hexahedron::weights(place->u);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto point = static_cast<std::size_t>(from.corners[8 * place->cell + i]);
      for (const auto source : around[point])
        rows[target].push_back(
            {source, static_cast<float>(weights[static_cast<Eigen::Index>(i)] *
                                        from.volume[static_cast<std::size_t>(source)] / volume[point])});
    }
  });
  take_nearest(from, to, rows);
}

void Interpolator::take_nearest(const field::Mesh& from, const Places& to,
                                std::vector<std::vector<Entry>>& rows) {
  const Nearest sources(from.centre);
  begin_ = {0};
  nearest_.resize(rows.size());
  for (std::size_t target = 0; target < rows.size(); ++target) {
    auto& row = rows[target];
    nearest_[target] = row.empty();
    if (row.empty()) {
      ++n_outside_;
      row.push_back({static_cast<std::int32_t>(sources.find(row_of(to.centre, target), 1).front()), 1});
    }
    entries_.insert(entries_.end(), row.begin(), row.end());
    begin_.push_back(entries_.size());
    std::vector<Entry>().swap(row);
  }
}

void Interpolator::apply(std::span<const float> values, std::span<const float> importance,
                         std::span<float> result) const {
  check(result.size() == n_target(), "interpolation: a place for every target");
  for (std::size_t target = 0; target < result.size(); ++target) {
    double sum = 0, total = 0, plain = 0, plain_total = 0;
    for (auto i = begin_[target]; i < begin_[target + 1]; ++i) {
      const auto cell = static_cast<std::size_t>(entries_[i].cell);
      const double weight = static_cast<double>(entries_[i].weight);
      const double value = static_cast<double>(values[cell]);
      const double counts = importance.empty() ? weight : weight * static_cast<double>(importance[cell]);
      sum += counts * value;
      total += counts;
      plain += weight * value;
      plain_total += weight;
    }
    result[target] = static_cast<float>(total > 0 ? sum / total : plain / plain_total);
  }
}

double Interpolator::integral(std::span<const float> values) const {
  double sum = 0;
  for (std::size_t target = 0; target < n_target(); ++target) {
    if (nearest_[target]) continue;
    for (auto i = begin_[target]; i < begin_[target + 1]; ++i)
      sum += static_cast<double>(entries_[i].weight) *
             static_cast<double>(values[static_cast<std::size_t>(entries_[i].cell)]);
  }
  return sum;
}

}  // namespace elrom::fields
