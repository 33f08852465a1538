#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "svg.hpp"

namespace elrom::report::svg {
namespace {

// Smallest of 1, 2, 5 times a power of ten that is no less than `rough`.
double round_step(double rough) {
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= rough * (1 - 1e-9)) return digit * power;
  return 10 * power;
}

std::vector<double> log_ticks(const Axis& axis, int wanted) {
  const int first = static_cast<int>(std::ceil(std::log10(axis.low) - 1e-9));
  const int last = static_cast<int>(std::floor(std::log10(axis.high) + 1e-9));
  const int stride = std::max(1, (last - first + wanted) / std::max(1, wanted));
  std::vector<double> result;
  for (int power = first; power <= last; power += stride) result.push_back(std::pow(10.0, power));
  if (result.size() >= 2) return result;
  result.clear();  // less than two decades: 1, 2, 5 in each
  for (int power = first - 1; power <= last; ++power)
    for (const double digit : {1.0, 2.0, 5.0}) {
      const double tick = digit * std::pow(10.0, power);
      if (tick >= axis.low && tick <= axis.high) result.push_back(tick);
    }
  return result;
}

}  // namespace

double Axis::fraction(double value) const {
  if (scale == Scale::log) return std::log(value / low) / std::log(high / low);
  return (value - low) / (high - low);
}

std::vector<double> ticks(const Axis& axis, int wanted) {
  if (axis.scale == Scale::log) return log_ticks(axis, wanted);
  const double step = round_step((axis.high - axis.low) / std::max(1, wanted));
  std::vector<double> result;
  const auto first = static_cast<long long>(std::ceil(axis.low / step - 1e-9));
  const auto last = static_cast<long long>(std::floor(axis.high / step + 1e-9));
  for (long long i = first; i <= last; ++i) result.push_back(static_cast<double>(i) * step);
  return result;
}

std::string tick_label(double value) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  if (size >= 1e5 || size < 1e-3) {
    const int power = static_cast<int>(std::floor(std::log10(size) + 1e-9));
    return fmt::format("{:.3g}e{}", value / std::pow(10.0, power), power);
  }
  return fmt::format("{:.4g}", value);
}

Axis fit_axis(std::string label, std::span<const double> values, std::optional<double> log_decades) {
  double low = std::numeric_limits<double>::infinity(), high = -low, least_positive = low;
  bool all_positive = true;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
    if (value > 0) least_positive = std::min(least_positive, value);
    all_positive = all_positive && value > 0;
  }
  if (!(low <= high)) return {std::move(label), 0, 1, Scale::linear};
  if (log_decades && all_positive && high >= least_positive * std::pow(10.0, *log_decades))
    return {std::move(label), least_positive / 1.15, high * 1.15, Scale::log};
  const double room = high > low ? 0.04 * (high - low) : std::max(1e-12, 0.1 * std::abs(high));
  return {std::move(label), low - room, high + room, Scale::linear};
}

std::string escape(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

}  // namespace elrom::report::svg
