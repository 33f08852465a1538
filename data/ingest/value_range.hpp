#pragma once
// Least, mean and most of values, as a summary shows them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>

namespace elrom::ingest {

// JSON has no NaN.
inline nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// Smallest, largest and mean of values that come in pieces.
struct ValueRange {
  double least = std::numeric_limits<double>::infinity(), most = -least, sum = 0;
  std::size_t n = 0;

  void add(double value) {
    if (std::isnan(value)) return;
    least = std::min(least, value);
    most = std::max(most, value);
    sum += value;
    ++n;
  }
  [[nodiscard]] nlohmann::ordered_json json() const {
    return {{"min", number_or_null(least)},
            {"mean", number_or_null(n > 0 ? sum / static_cast<double>(n) : std::nan(""))},
            {"max", number_or_null(most)}};
  }
};

}  // namespace elrom::ingest
