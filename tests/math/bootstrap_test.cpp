#include "elrom/math/bootstrap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace elrom::math {
namespace {

double mean_of(const std::vector<double>& values, std::span<const std::size_t> rows) {
  double sum = 0;
  for (const auto row : rows) sum += values[row];
  return sum / static_cast<double>(rows.size());
}

TEST(Bootstrap, StudentsQuantilesAreThoseOfTheTables) {
  EXPECT_NEAR(student_quantile(0.90, 1), 6.314, 5e-4);
  EXPECT_NEAR(student_quantile(0.90, 2), 2.920, 5e-4);
  EXPECT_NEAR(student_quantile(0.90, 4), 2.132, 5e-4);
  EXPECT_NEAR(student_quantile(0.95, 5), 2.571, 5e-4);
  EXPECT_NEAR(student_quantile(0.99, 30), 2.750, 5e-4);
}

// Many cases: Student's and the bootstrap's intervals of a mean agree.
TEST(Bootstrap, IntervalOfAMeanIsThatOfTheTextbook) {
  base::Random random{base::Seed(5)};
  std::vector<double> values(60);
  for (auto& value : values) value = random.normal();
  const auto figure = [&](std::span<const std::size_t> rows) { return mean_of(values, rows); };
  std::vector<std::size_t> all(values.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const double mean = figure(all);
  double squares = 0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  const double reach = student_quantile(0.9, 59) * std::sqrt(squares / 59 / 60);

  const auto interval = bootstrap_interval(60, figure);

  ASSERT_TRUE(interval);
  EXPECT_NEAR(interval->low, mean - reach, 0.1 * reach);
  EXPECT_NEAR(interval->high, mean + reach, 0.1 * reach);
}

// The promise that counts with five held-out cases: 90 % of such intervals hold the mean, less what draws
// of five values cannot reach.
TEST(Bootstrap, FiveCasesHoldTheMeanAboutAsOftenAsPromised) {
  base::Random random{base::Seed(6)};
  constexpr int n_sets = 600;
  int held = 0;
  for (int i = 0; i < n_sets; ++i) {
    std::vector<double> values(5);
    for (auto& value : values) value = random.normal();
    const auto interval = bootstrap_interval(
        5, [&](std::span<const std::size_t> rows) { return mean_of(values, rows); }, {.n_draws = 400});
    held += interval && interval->low <= 0 && interval->high >= 0;
  }
  EXPECT_GT(held, 0.84 * n_sets);  // the plain percentile bootstrap: 0.79
  EXPECT_LT(held, 0.94 * n_sets);
}

TEST(Bootstrap, TheSameSeedGivesTheSameInterval) {
  const std::vector<double> values{1, 3, 2, 7};
  const auto figure = [&](std::span<const std::size_t> rows) { return mean_of(values, rows); };

  const auto one = bootstrap_interval(4, figure), same = bootstrap_interval(4, figure),
             other = bootstrap_interval(4, figure, {.n_draws = 50, .seed = base::Seed(2)});

  EXPECT_EQ(one->low, same->low);
  EXPECT_EQ(one->high, same->high);
  EXPECT_NE(one->high, other->high);
}

TEST(Bootstrap, TwoCasesGiveNoInterval) {
  EXPECT_FALSE(bootstrap_interval(2, [](std::span<const std::size_t>) { return 1.0; }));
  EXPECT_FALSE(bootstrap_interval(5, [](std::span<const std::size_t>) { return std::nan(""); }));
}

}  // namespace
}  // namespace elrom::math
