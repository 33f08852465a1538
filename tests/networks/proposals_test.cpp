#include "proposals.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace elrom::networks {
namespace {

TEST(Sobol, FirstPointsFillEveryDyadicIntervalOnce) {
  const std::vector<double> shift(6, 0.0);
  for (std::size_t d = 0; d < 6; ++d) {
    std::set<int> sixteenths;
    for (std::size_t i = 0; i < 16; ++i) sixteenths.insert(static_cast<int>(sobol_point(i, shift)[d] * 16));
    EXPECT_EQ(sixteenths.size(), 16u) << "dimension " << d;
  }
}

// A bowl that random points do not find the bottom of in so few trials.
struct Bowl {
  double best = HUGE_VAL;
  int asked = 0, most = 60;
  double operator()(std::span<const double> x) {
    if (asked == most) throw SearchEnded();
    ++asked;
    const double value = std::pow(x[0] - 0.31, 2) + 3 * std::pow(x[1] - 0.77, 2);
    best = std::min(best, value);
    return value;
  }
};

TEST(Proposals, SobolEndsInALocalSearchThatFindsTheBottom) {
  Bowl bowl;

  propose("sobol_bobyqa", 2, {0.1, 0.1}, 60, base::Seed(1),
          [&](std::span<const double> x) { return bowl(x); });

  EXPECT_LT(bowl.best, 1e-5) << "a local search goes within its tolerance, 1e-3, of it";
}

TEST(Proposals, SobolPointsComeFirst) {
  std::vector<std::vector<double>> asked;

  propose("sobol_bobyqa", 2, {0.1, 0.1}, 8, base::Seed(1), [&](std::span<const double> x) {
    if (asked.size() == 4) throw SearchEnded();
    asked.emplace_back(x.begin(), x.end());
    return 0.5;
  });

  // Shifted alike: differences of the sequence's own first points, whatever the shift.
  const auto first = sobol_point(0, std::vector<double>(2, 0)),
             second = sobol_point(1, std::vector<double>(2, 0));
  ASSERT_GE(asked.size(), 2U);
  for (std::size_t d = 0; d < 2; ++d) {
    const double step = asked[1][d] - asked[0][d] - (second[d] - first[d]);
    EXPECT_NEAR(step, std::round(step), 1e-12);
  }
}

}  // namespace
}  // namespace elrom::networks
