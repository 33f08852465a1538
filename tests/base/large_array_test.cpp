#include "elrom/base/large_array.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>

namespace elrom::base {
namespace {

TEST(LargeArray, KeepsItsValuesWhileItGrowsFromSmallToLarge) {
  LargeArray<float> values;
  for (const std::size_t n : {std::size_t{10}, std::size_t{1} << 17, std::size_t{1} << 20}) {
    const auto before = values.size();
    values.resize(n);
    for (std::size_t i = before; i < n; ++i) values[i] = static_cast<float>(i);
  }

  for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(values[i], static_cast<float>(i));
}

TEST(LargeArray, StartsOnACacheLine) {
  for (const std::size_t n : {std::size_t{1}, std::size_t{100'000}, std::size_t{500'000}}) {
    const LargeArray<float> values(n, 1.0F);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(values.data()) % 64, 0U);
    EXPECT_EQ(std::accumulate(values.begin(), values.end(), 0.0), static_cast<double>(n));
  }
}

}  // namespace
}  // namespace elrom::base
