// What training cases' own audits say of a prediction's.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/audit.hpp"

namespace elrom::model {
namespace {

constexpr std::size_t fewest_cases = 3;
constexpr double usual_deviations = 3;
// Cases of a solver that conserves to the last digit leave no scatter to compare with.
constexpr double least_scatter = 1e-3;

std::optional<double> ratio(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b || *b == 0 || !std::isfinite(*a / *b)) return std::nullopt;
  return *a / *b;
}

struct Figure {
  const char* name;
  std::optional<double> value;
};

std::array<Figure, 3> figures_of(const Audit& audit) {
  return {{{"solids over inventory", ratio(audit.solids_kg, audit.inventory_kg)},
           {"gas flow over the inlets'", audit.gas_balance},
           {"pressure drop over the weight of the solids", ratio(audit.pressure_drop, audit.solids_weight)}}};
}

}  // namespace

std::vector<UsualFigure> usual_figures(std::span<const Audit> cases) {
  std::array<math::RunningMoments, 3> statistics;
  std::vector<UsualFigure> usual;
  for (const auto& one : cases) {
    const auto figures = figures_of(one);
    for (std::size_t i = 0; i < figures.size(); ++i)
      if (figures[i].value) statistics[i].add(*figures[i].value);
  }
  const auto names = figures_of({});
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& one = statistics[i];
    if (one.count() >= fewest_cases)
      usual.push_back({names[i].name, one.mean(), one.deviation(), one.count()});
  }
  return usual;
}

std::vector<std::string> unusual_figures(const Audit& audit, std::span<const UsualFigure> usual) {
  std::vector<std::string> found;
  for (const auto& figure : figures_of(audit)) {
    const auto same = std::ranges::find(usual, figure.name, &UsualFigure::name);
    if (same == usual.end() || !figure.value) continue;
    const double deviation = std::max(same->deviation, least_scatter);
    if (std::abs(*figure.value - same->mean) <= usual_deviations * deviation) continue;
    found.push_back(fmt::format("{} is {}: {:.2f} +- {} in {} training cases", figure.name,
                                base::rounded(*figure.value, 3), same->mean, base::rounded(deviation, 2),
                                same->n_cases));
  }
  return found;
}

}  // namespace elrom::model
