// Gains with their intervals: the same ratio of pooled errors, taken of cases that are drawn anew.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "elrom/math/statistics.hpp"
#include "elrom/report/accuracy.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

double pooled_nrmse(const MethodField& method, std::span<const std::size_t> cases) {
  double error = 0, departure = 0;
  for (const auto i : cases) {
    error += method.cases[i].error;
    departure += method.cases[i].departure;
  }
  return math::nrmse(error, departure);
}

double mean_nrmse(std::span<const FieldAccuracy> fields, std::size_t method,
                  std::span<const std::size_t> cases, Truth truth) {
  double sum = 0;
  for (const auto& field : fields)
    sum += truth == Truth::averaged ? field.averaged_nrmse(method, cases)
                                    : pooled_nrmse(field.methods[method], cases);
  return sum / static_cast<double>(fields.size());
}

bool all_have(std::span<const FieldAccuracy> fields, std::size_t method) {
  return std::ranges::all_of(fields, [&](const FieldAccuracy& f) { return f.methods[method].available; });
}

}  // namespace

Gain::Verdict Gain::verdict() const {
  if (!interval || (interval->low <= 0 && interval->high >= 0)) return Verdict::not_shown;
  return interval->low > 0 ? Verdict::better : Verdict::worse;
}

Gain relative_gain(std::span<const FieldAccuracy> fields, std::size_t method, std::size_t other,
                   Truth truth) {
  if (fields.empty() || !all_have(fields, method) || !all_have(fields, other)) return {undefined, {}};
  const auto of_cases = [&](std::span<const std::size_t> cases) {
    return 1 - mean_nrmse(fields, method, cases, truth) / mean_nrmse(fields, other, cases, truth);
  };
  const auto all = math::all_rows(fields.front().methods[method].cases.size());
  return {of_cases(all), math::bootstrap_interval(all.size(), of_cases, {.level = gain_level})};
}

double FieldAccuracy::averaged_nrmse(std::size_t method, std::span<const std::size_t> cases) const {
  if (averaged_noise.empty() || !methods[method].available) return undefined;
  double error = 0, departure = 0;
  for (const auto i : cases) {
    error += methods[method].averaged[i].error - averaged_noise[i];
    departure += methods[method].averaged[i].departure - averaged_noise[i];
  }
  return signed_nrmse(error, departure);
}

MeanError AccuracyReport::averaged_error(std::size_t method) const {
  if (!has_averaged_truth() || fields.empty()) return {undefined, {}};
  const auto of_cases = [&](std::span<const std::size_t> drawn) {
    return mean_nrmse(fields, method, drawn, Truth::averaged);
  };
  return {of_cases(math::all_rows(cases.size())),
          math::bootstrap_interval(cases.size(), of_cases, {.level = gain_level})};
}

std::optional<std::size_t> AccuracyReport::best_averaged_peer() const {
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  const auto all = math::all_rows(cases.size());
  for (std::size_t m = 1; m < methods.size() && has_averaged_truth(); ++m) {
    const double error = methods[m].file.is_peer ? mean_nrmse(fields, m, all, Truth::averaged) : undefined;
    if (error < least) best = m, least = error;
  }
  return best;
}

Gain AccuracyReport::averaged_gain() const {
  const auto best = best_averaged_peer();
  return best ? relative_gain(fields, 0, *best, Truth::averaged) : Gain{undefined, {}};
}

std::string in_words(const Gain& gain) {
  auto text = percent_text(std::abs(gain.value));
  if (!gain.interval) return text + " (too few cases for an interval)";
  double low = gain.interval->low, high = gain.interval->high;
  if (gain.value < 0) std::tie(low, high) = std::pair(-high, -low);
  return text + fmt::format(" ({:.0f} % interval {:.1f} to {:.1f} %{})", 100 * gain_level, 100 * low,
                            100 * high,
                            gain.verdict() == Gain::Verdict::not_shown ? ": no difference shown" : "");
}

Gain AccuracyReport::gain() const {
  const auto best = best_peer();
  return best ? relative_gain(fields, 0, *best) : Gain{undefined, {}};
}

Gain AccuracyReport::gain(const FieldAccuracy& field) const {
  const auto best = best_peer(field);
  return best ? relative_gain({&field, 1}, 0, *best) : Gain{undefined, {}};
}

double AccuracyReport::gain_without_noise() const {
  const auto best = best_peer();
  if (!best || std::ranges::any_of(fields, [&](const FieldAccuracy& field) {
        return field.below_noise(0) || field.below_noise(*best);
      }))
    return undefined;
  return 1 - methods[0].mean_nrmse_without_noise / methods[*best].mean_nrmse_without_noise;
}

std::size_t AccuracyReport::fields_won() const {
  return static_cast<std::size_t>(std::ranges::count_if(fields, [this](const FieldAccuracy& field) {
    const auto best = best_peer(field);
    return best && field.nrmse(0) <= field.nrmse(*best);
  }));
}

std::size_t AccuracyReport::fields_won_against_all() const {
  return static_cast<std::size_t>(std::ranges::count_if(fields, [this](const FieldAccuracy& field) {
    for (std::size_t m = 1; m < methods.size(); ++m)
      if (field.nrmse(m) < field.nrmse(0)) return false;
    return true;
  }));
}

std::vector<std::size_t> AccuracyReport::fields_better(std::size_t method) const {
  std::vector<std::size_t> better;
  for (std::size_t f = 0; f < fields.size(); ++f)
    if (fields[f].nrmse(method) < fields[f].nrmse(0)) better.push_back(f);
  return better;
}

double FieldAccuracy::nrmse_without_noise(std::size_t method) const {
  if (noise.empty() || !methods[method].available) return undefined;
  return report::nrmse_without_noise(methods[method].pooled, noise_energy());
}

bool FieldAccuracy::below_noise(std::size_t method) const {
  return !noise.empty() && methods[method].available && methods[method].pooled.error <= noise_energy();
}

bool FieldAccuracy::above_noise() const {
  if (noise.empty() || !std::isfinite(nrmse_without_noise(0))) return false;
  for (std::size_t m = 0; m < methods.size(); ++m)
    if (below_noise(m)) return false;
  return true;
}

std::size_t AccuracyReport::fields_below_noise() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(fields, [](const FieldAccuracy& field) { return field.below_noise(0); }));
}

std::size_t AccuracyReport::fields_above_noise() const {
  return static_cast<std::size_t>(std::ranges::count_if(fields, &FieldAccuracy::above_noise));
}

}  // namespace elrom::report
