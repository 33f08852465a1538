#include "elrom/ingest/case_summary.hpp"

#include <algorithm>
#include <cmath>

#include "boxes.hpp"
#include "elrom/base/digest.hpp"
#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

std::ptrdiff_t find_field(const CheckedCase& view, std::string_view name) {
  for (std::size_t f = 0; f < view.fields.size(); ++f) {
    if (view.fields[f].name == name) return static_cast<std::ptrdiff_t>(f);
  }
  return -1;
}

/// Mean of `value(i)` over the cells that `wanted`, weighted by `weight(i)`; cells that are not finite are
/// left out.
template <class Value, class Weight, class Wanted>
double mean(Eigen::Index n, Value value, Weight weight, Wanted wanted) {
  double sum = 0, total = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!wanted(i)) continue;
    const double v = value(i), w = weight(i);
    if (!std::isfinite(v) || !std::isfinite(w)) continue;
    sum += w * v;
    total += w;
  }
  return total > 0 ? sum / total : undefined;
}

class Measuring {
 public:
  Measuring(const CheckedCase& view, const Boxes& boxes) : view_(view), boxes_(boxes) {}

  [[nodiscard]] std::array<double, n_measures> all() const {
    std::array<double, n_measures> m{};
    m[0] = rms("solid_velocity_x");
    m[1] = rms("solid_velocity_y");
    m[2] = rms("solid_velocity_z");
    m[3] = rms("gas_velocity_x");
    m[4] = rms("gas_velocity_y");
    m[5] = rms("gas_velocity_z");
    m[6] = mean_between("gas_velocity_z", 0.5, 0.8);
    m[7] = mean_between("pressure", 0, 0.1) - mean_between("pressure", 0.9, 1);
    m[8] = mean_diameter();
    m[9] = solids_volume();
    return m;
  }

 private:
  [[nodiscard]] auto value(std::ptrdiff_t f) const {
    return [this, f](Eigen::Index i) { return static_cast<double>(view_.values(f, i)); };
  }
  [[nodiscard]] auto cell_weight() const {
    return [this](Eigen::Index i) { return boxes_.weight(i); };
  }
  static bool everywhere(Eigen::Index) { return true; }

  [[nodiscard]] double rms(std::string_view name) const {
    const auto f = find_field(view_, name);
    if (f < 0) return undefined;
    const auto v = value(f);
    return std::sqrt(mean(
        view_.values.cols(), [&](Eigen::Index i) { return v(i) * v(i); }, cell_weight(), everywhere));
  }
  [[nodiscard]] double mean_between(std::string_view name, double low, double high) const {
    const auto f = find_field(view_, name);
    if (f < 0) return undefined;
    return mean(view_.values.cols(), value(f), cell_weight(), [&](Eigen::Index i) {
      const double z = boxes_.relative(i, 2);
      return z >= low && z <= high;
    });
  }
  [[nodiscard]] double mean_diameter() const {
    const auto d = find_field(view_, "solid_diameter"), e = find_field(view_, "solid_volume_fraction");
    if (d < 0 || e < 0) return undefined;
    const auto fraction = value(e);
    return mean(
        view_.values.cols(), value(d), [&](Eigen::Index i) { return boxes_.weight(i) * fraction(i); },
        everywhere);
  }
  [[nodiscard]] double solids_volume() const {
    const auto e = find_field(view_, "solid_volume_fraction");
    if (e < 0) return undefined;
    double total = 0;
    for (Eigen::Index i = 0; i < view_.values.cols(); ++i) total += boxes_.weight(i);
    return total * mean(view_.values.cols(), value(e), cell_weight(), everywhere);
  }

  const CheckedCase& view_;
  const Boxes& boxes_;
};

MatrixF make_sketch(const CheckedCase& view, const Boxes& boxes) {
  const Eigen::Index n_boxes = Boxes::n_boxes;
  MatrixD sum = MatrixD::Zero(view.values.rows(), n_boxes), total = sum;
  for (Eigen::Index i = 0; i < view.values.cols(); ++i) {
    const int box = boxes.box(i);
    const double w = boxes.weight(i);
    for (Eigen::Index f = 0; f < view.values.rows(); ++f) {
      const double v = view.values(f, i);
      if (!std::isfinite(v)) continue;
      sum(f, box) += w * v;
      total(f, box) += w;
    }
  }
  return (total.array() > 0).select(sum.array() / total.array().max(1e-300), 0.0).cast<float>();
}

/// Adds to `bad` the cells of field f for which `wrong` holds, as one entry.
template <class Wrong>
void note_cells(const CheckedCase& view, Eigen::Index f, Wrong wrong, std::vector<BadCell>& bad) {
  BadCell found;
  for (Eigen::Index i = 0; i < view.values.cols(); ++i) {
    if (!wrong(view.values(f, i))) continue;
    if (found.count++ == 0) {
      found.field = view.fields[static_cast<std::size_t>(f)].name;
      found.cell = i;
      found.value = view.values(f, i);
    }
  }
  if (found.count > 0) bad.push_back(found);
}

}  // namespace

std::string_view field_of(Measure measure) {
  constexpr std::array<std::string_view, n_measures> names{
      "solid_velocity_x", "solid_velocity_y", "solid_velocity_z", "gas_velocity_x", "gas_velocity_y",
      "gas_velocity_z",   "gas_velocity_z",   "pressure",         "solid_diameter", "solid_volume_fraction"};
  return names[static_cast<std::size_t>(measure)];
}

CaseSummary summarise(const CheckedCase& view) {
  const Boxes boxes(view);
  CaseSummary summary;
  summary.name = view.name;
  summary.load = view.load;
  if (view.schema) summary.schema = *view.schema;
  summary.inputs.assign(view.inputs.begin(), view.inputs.end());
  for (const auto& info : view.fields) summary.fields.push_back(info.name);
  summary.measures = Measuring(view, boxes).all();
  summary.height = boxes.extent(2);
  summary.has_volume = !view.volume.empty();
  double volume = 0;
  for (const double v : view.volume) volume += v;
  // Centres span a cell less than the furnace; a mean section needs no better.
  summary.area =
      summary.has_volume && summary.height > 0 ? volume / summary.height : boxes.extent(0) * boxes.extent(1);
  summary.sketch = make_sketch(view, boxes);
  summary.digest = base::sha256(
      std::as_bytes(std::span(view.values.data(), static_cast<std::size_t>(view.values.size()))));
  for (Eigen::Index f = 0; f < view.values.rows(); ++f) {
    const auto& info = view.fields[static_cast<std::size_t>(f)];
    // Rounding to float may put a value a last digit beyond its bound.
    const double lower = info.lower.value_or(-std::numeric_limits<double>::infinity());
    const double upper = info.upper.value_or(std::numeric_limits<double>::infinity()) * (1 + 1e-6);
    note_cells(
        view, f, [](float v) { return !std::isfinite(v); }, summary.not_finite);
    note_cells(
        view, f, [&](float v) { return v < lower || v > upper; }, summary.out_of_bounds);
  }
  summary.readings = read_physics(view);
  return summary;
}

}  // namespace elrom::ingest
