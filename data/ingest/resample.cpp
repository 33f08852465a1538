#include "elrom/ingest/resample.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "gradient.hpp"

namespace elrom::ingest {

namespace {

std::vector<Point> points_of(const MatrixD& centre) {
  std::vector<Point> points(static_cast<std::size_t>(centre.rows()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d)
      points[i][d] = centre(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d));
  }
  return points;
}

// Source cells that belong to each target.
std::vector<std::vector<std::int32_t>> assign(const CellCloud& sources, const CellCloud& targets) {
  std::vector<std::vector<std::int32_t>> parents(targets.size());
  for (std::size_t cell = 0; cell < sources.size(); ++cell) {
    for (const auto target : targets.nearest(sources.at(cell), 1)) {
      parents[static_cast<std::size_t>(target)].push_back(static_cast<std::int32_t>(cell));
    }
  }
  return parents;
}

/// Source cells and their weights, ascending by cell.
using Row = std::vector<std::pair<std::int32_t, double>>;

// Entries of one cell become one.
void merge(Row& row) {
  std::stable_sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < row.size(); ++i) {
    if (row[i].first == row[kept].first) {
      row[kept].second += row[i].second;
    } else {
      row[++kept] = row[i];
    }
  }
  row.resize(kept + 1);
  row.shrink_to_fit();
}

class Builder {
 public:
  Builder(const CellCloud& sources, std::span<const double> volume) : sources_(sources), volume_(volume) {}

  [[nodiscard]] Row row(const std::vector<std::int32_t>& parents, const Point& x) const {
    Row row;
    double total = 0;
    Point mean{};
    for (const auto cell : parents) total += volume(cell);
    for (const auto cell : parents) {
      const double share = volume(cell) / total;
      row.emplace_back(cell, share);
      const auto y = sources_.at(static_cast<std::size_t>(cell));
      for (std::size_t d = 0; d < 3; ++d) mean[d] += share * y[d];
    }
    for (const auto cell : parents) {
      const double share = volume(cell) / total;
      for (const auto& [n, c] : sources_.gradient(static_cast<std::size_t>(cell)).entries) {
        double slope = 0;
        for (std::size_t d = 0; d < 3; ++d) slope += c[d] * (x[d] - mean[d]);
        row.emplace_back(n, share * slope);
      }
    }
    merge(row);
    return row;
  }

 private:
  [[nodiscard]] double volume(std::int32_t cell) const {
    return volume_.empty() ? 1.0 : volume_[static_cast<std::size_t>(cell)];
  }
  const CellCloud& sources_;
  std::span<const double> volume_;
};

bool in_hull_of_row(const Row& row, const CellCloud& sources, const Point& x, double tolerance) {
  std::vector<Point> points;
  points.reserve(row.size());
  for (const auto& [cell, weight] : row) points.push_back(sources.at(static_cast<std::size_t>(cell)));
  return PointHull(std::move(points)).contains(x, tolerance);
}

double square_between(const Point& a, const Point& b) {
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d) sum += (a[d] - b[d]) * (a[d] - b[d]);
  return sum;
}

bool is_out_of_reach(const CellCloud& sources, const Point& x) {
  const auto cell = static_cast<std::size_t>(sources.nearest(x, 1).front());
  const auto y = sources.at(cell);
  double reach = 0;
  for (const auto& [n, c] : sources.gradient(cell).entries)
    reach = std::max(reach, square_between(y, sources.at(static_cast<std::size_t>(n))));
  return square_between(x, y) > reach;
}

}  // namespace

Resampler::Resampler(const MatrixD& source_centre, std::span<const double> source_volume,
                     const MatrixD& target_centre, int n_threads, const std::stop_token& stop)
    : n_source_(static_cast<std::size_t>(source_centre.rows())) {
  if (n_source_ == 0) throw InputError("a mesh without cells cannot be resampled");
  check(source_volume.empty() || source_volume.size() == n_source_, "volumes and centres differ in number");
  const CellCloud sources(source_centre), targets(target_centre);
  const PointHull hull(points_of(source_centre));
  const double extent = (source_centre.colwise().maxCoeff() - source_centre.colwise().minCoeff()).maxCoeff();
  const double tolerance = std::max(1e-9 * extent, 1e-300);
  const auto parents = assign(sources, targets);
  const Builder builder(sources, source_volume);
  std::vector<Row> rows(targets.size());
  limits_.resize(targets.size());
  is_far_.resize(targets.size());
  base::parallel_for(
      targets.size(), n_threads,
      [&](std::size_t t, int) {
        const auto x = targets.at(t);
        rows[t] = builder.row(parents[t].empty() ? sources.nearest(x, 1) : parents[t], x);
        if (in_hull_of_row(rows[t], sources, x, tolerance)) {
          limits_[t] = Limit::stencil;
        } else {
          limits_[t] = hull.contains(x, tolerance) ? Limit::everything : Limit::stencil_outside;
        }
        is_far_[t] = limits_[t] == Limit::stencil_outside && is_out_of_reach(sources, x) ? 1 : 0;
      },
      stop);
  begin_.assign(1, 0);
  for (const auto& row : rows) {
    for (const auto& [cell, weight] : row) {
      cell_.push_back(cell);
      weight_.push_back(weight);
    }
    begin_.push_back(cell_.size());
  }
}

std::size_t Resampler::n_outside() const {
  return static_cast<std::size_t>(std::count(limits_.begin(), limits_.end(), Limit::stencil_outside));
}

std::size_t Resampler::n_far() const {
  return static_cast<std::size_t>(std::count(is_far_.begin(), is_far_.end(), 1));
}

void Resampler::apply(std::span<const float> source, std::span<float> target) const {
  check(source.size() == n_source() && target.size() == n_target(), "fields of other meshes");
  const auto [least, most] = std::minmax_element(source.begin(), source.end());
  for (std::size_t t = 0; t < target.size(); ++t) {
    const auto first = source[static_cast<std::size_t>(cell_[begin_[t]])];
    float low = first, high = first;
    double sum = 0;
    for (auto entry = begin_[t]; entry < begin_[t + 1]; ++entry) {
      const float value = source[static_cast<std::size_t>(cell_[entry])];
      low = std::min(low, value);
      high = std::max(high, value);
      sum += weight_[entry] * static_cast<double>(value);
    }
    if (limits_[t] == Limit::everything) {
      low = *least;
      high = *most;
    }
    target[t] = std::clamp(static_cast<float>(sum), low, high);
  }
}

MatrixF Resampler::apply(const MatrixF& source) const {
  MatrixF target(source.rows(), static_cast<Eigen::Index>(n_target()));
  for (Eigen::Index row = 0; row < source.rows(); ++row) {
    apply({source.row(row).data(), n_source()}, {target.row(row).data(), n_target()});
  }
  return target;
}

std::vector<double> round_trip_error(const MatrixF& original, const MatrixF& back) {
  check(original.rows() == back.rows() && original.cols() == back.cols(), "fields of different shape");
  std::vector<double> errors;
  for (Eigen::Index row = 0; row < original.rows(); ++row) {
    const Eigen::ArrayXd before = original.row(row).cast<double>().transpose().array();
    const Eigen::ArrayXd after = back.row(row).cast<double>().transpose().array();
    const double rms = std::sqrt((after - before).square().mean());
    const double deviation = std::sqrt((before - before.mean()).square().mean());
    const double scale = deviation > 0 ? deviation : before.abs().maxCoeff();
    errors.push_back(rms == 0 ? 0.0 : rms / scale);
  }
  return errors;
}

}  // namespace elrom::ingest
