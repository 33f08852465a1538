#pragma once
// How two quantities of the cells go together.

#include <cmath>
#include <cstddef>

namespace elrom::ingest {

/// Correlation of a(i) and b(i), i < n, weighted by weight(i). NaN where one of them is constant.
template <class Weight, class A, class B>
[[nodiscard]] double correlation(std::size_t n, Weight weight, A a, B b) {
  double total = 0, mean_a = 0, mean_b = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < n; ++i) {
    total += weight(i);
    mean_a += weight(i) * a(i);
    mean_b += weight(i) * b(i);
  }
  mean_a /= total;
  mean_b /= total;
  for (std::size_t i = 0; i < n; ++i) {
    const double w = weight(i), x = a(i) - mean_a, y = b(i) - mean_b;
    aa += w * x * x;
    bb += w * y * y;
    ab += w * x * y;
  }
  return ab / std::sqrt(aa * bb);
}

}  // namespace elrom::ingest
