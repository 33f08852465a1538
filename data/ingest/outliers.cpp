#include "outliers.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/math/linear_algebra.hpp"
#include "elrom/model/operating_line.hpp"
#include "robust.hpp"

namespace elrom::ingest {
namespace {

constexpr std::size_t fewest_cases = 10;
// Of twins, in typical distances between cases ...
constexpr double nearest_twins = 0.001, farthest_twins = 0.02;
constexpr double twin_share = 0.01;     // ... and of a case's usual distance to its nearest
constexpr double infinitely_far = 1e6;  // where all other cases are equal
constexpr std::size_t most_pairs = 3000;

/// In units of the usual distance. Healthy real cases stay below 1.9 among 73 (see the tests), and below 4.2
/// in stores of more than 25.
double far_distance(std::size_t n_cases) { return 4.5 * model::growth_for_few(n_cases); }

std::vector<double> list_of(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

/// Sketches of one field as rows, (n_cases, n_boxes).
MatrixD rows_of(std::span<const CaseSummary> cases, Eigen::Index field) {
  MatrixD rows(static_cast<Eigen::Index>(cases.size()), cases[0].sketch.cols());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    rows.row(i) = cases[static_cast<std::size_t>(i)].sketch.row(field).cast<double>();
  }
  return rows;
}

/// Squared distances between all pairs, relative to their median, averaged over fields.
MatrixD relative_distances(std::span<const CaseSummary> cases) {
  const auto n = static_cast<Eigen::Index>(cases.size());
  MatrixD total = MatrixD::Zero(n, n);
  int n_used = 0;
  for (Eigen::Index f = 0; f < cases[0].sketch.rows(); ++f) {
    const auto rows = rows_of(cases, f);
    MatrixD squared(n, n);
    std::vector<double> pairs;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        squared(i, j) = squared(j, i) = (rows.row(i) - rows.row(j)).squaredNorm();
        if (j < i) pairs.push_back(squared(i, j));
      }
    }
    const double usual = median(pairs);
    if (!(usual > 0)) continue;
    total += squared / usual;
    ++n_used;
  }
  return total / std::max(1, n_used);
}

/// The most that twins can be apart. Cases of a few inputs lie the nearer to each other the more they are,
/// with no mistake in it; a copy lies nearer than that by far.
double twin_distance(const MatrixD& squared) {
  MatrixD others = squared;
  others.diagonal().setConstant(infinitely_far);
  const Eigen::VectorXd nearest = others.rowwise().minCoeff().cwiseSqrt();
  return std::clamp(twin_share * median(list_of(nearest)), nearest_twins, farthest_twins);
}

/// Leading directions of rows that were moved to the median and drawn onto the unit sphere, (n_boxes,
/// n_modes): a wild row then weighs no more than any other.
Eigen::MatrixXd spherical_modes(const MatrixD& centred, Eigen::Index n_modes) {
  MatrixD sphere = centred;
  for (Eigen::Index i = 0; i < sphere.rows(); ++i) {
    const double norm = sphere.row(i).norm();
    if (norm > 0) sphere.row(i) /= norm;
  }
  const math::SymmetricEigen eigen = math::symmetric_eigen(sphere * sphere.transpose());
  Eigen::MatrixXd modes = sphere.transpose() * eigen.vectors.rightCols(n_modes);
  for (Eigen::Index k = 0; k < n_modes; ++k) {
    const double norm = modes.col(k).norm();
    if (norm > 1e-12) modes.col(k) /= norm;
  }
  return modes;
}

/// values / the size that nine cases in ten stay below
Eigen::VectorXd relative(const Eigen::VectorXd& values, double floor) {
  return values / std::max(quantile(list_of(values), 0.9), floor);
}

/// What the load does not explain: every box less its robust line over the load.
MatrixD without_load(const MatrixD& rows, const std::vector<double>& loads) {
  MatrixD rest(rows.rows(), rows.cols());
  for (Eigen::Index c = 0; c < rows.cols(); ++c) {
    const auto line = robust_line(loads, list_of(rows.col(c)), 1, most_pairs);
    for (Eigen::Index i = 0; i < rows.rows(); ++i)
      rest(i, c) = rows(i, c) - line.at(loads[static_cast<std::size_t>(i)]);
  }
  return rest;
}

Eigen::VectorXd field_distances(const MatrixD& rows, const std::vector<double>& loads) {
  const auto n = rows.rows();
  const auto rest = without_load(rows, loads);
  const double size = quantile(list_of(rest.rowwise().norm()), 0.5);
  if (!(size > 0)) return (rest.rowwise().norm().array() > 0).cast<double>() * infinitely_far;
  const Eigen::Index n_modes = std::clamp<Eigen::Index>(n / 6, 1, 8);
  const auto modes = spherical_modes(rest, n_modes);
  MatrixD scores = rest * modes;
  const Eigen::VectorXd off = (rest - scores * modes.transpose()).rowwise().norm();
  for (Eigen::Index k = 0; k < n_modes; ++k) {
    scores.col(k) /= std::max(quantile(list_of(scores.col(k).cwiseAbs()), 0.9), 1e-9 * size);
  }
  return relative(scores.rowwise().norm(), 1e-9).cwiseMax(relative(off, 1e-9 * size));
}

std::vector<double> loads_of(std::span<const CaseSummary> cases) {
  const CaseFeatures features(cases[0].schema);
  std::vector<std::vector<double>> rows;
  for (const auto& one : cases) rows.push_back(features.evaluate(one));
  const LoadProxy proxy(features, rows);
  std::vector<double> loads;
  for (const auto& row : rows) loads.push_back(proxy.of(row));
  return loads;
}

}  // namespace

std::vector<Twin> find_twins(std::span<const CaseSummary> cases) {
  std::vector<Twin> twins;
  if (cases.size() < 2) return twins;
  const auto distances = relative_distances(cases);
  const double near = twin_distance(distances);
  for (std::size_t j = 1; j < cases.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const bool exact = cases[i].digest == cases[j].digest;
      const double distance =
          std::sqrt(distances(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
      // Two cases alone have no typical distance but their own.
      if (exact || (cases.size() > 2 && distance < near)) twins.push_back({i, j, exact, distance});
    }
  }
  return twins;
}

MatrixD outlier_distances(std::span<const CaseSummary> cases) {
  const auto loads = loads_of(cases);
  MatrixD distances(cases[0].sketch.rows(), static_cast<Eigen::Index>(cases.size()));
  for (Eigen::Index f = 0; f < distances.rows(); ++f)
    distances.row(f) = field_distances(rows_of(cases, f), loads).transpose();
  return distances;
}

std::vector<Outlier> find_outliers(std::span<const CaseSummary> cases) {
  std::vector<Outlier> outliers;
  if (cases.size() < fewest_cases) return outliers;
  const auto distances = outlier_distances(cases);
  for (Eigen::Index i = 0; i < distances.cols(); ++i) {
    Eigen::Index field = 0;
    const double distance = distances.col(i).maxCoeff(&field);
    if (distance < far_distance(cases.size())) continue;
    outliers.push_back({static_cast<std::size_t>(i), cases[0].fields[static_cast<std::size_t>(field)],
                        distance, far_distance(cases.size())});
  }
  return outliers;
}

}  // namespace elrom::ingest
