#include "elrom/model/feature_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::model {
namespace {

using Kind = FeatureTerm::Kind;

FeatureMap velocity_and_imbalance() {
  const LinearForm flow{{0, 1}, {1, 1}, 0}, difference{{0, 1}, {0.5, -0.5}, 0}, spread{{2}, {1}, 0};
  return FeatureMap({{"velocity", {{Kind::logarithm, 1, flow, {}, 1e-3}, {Kind::square, 0.5, spread, {}, 0}}},
                     {"imbalance", {{Kind::quotient, 1, difference, flow, 1e-3}}},
                     {"share", {{Kind::value, 2, {{2}, {1}, -0.5}, {}, 0}}}},
                    3);
}

std::vector<double> values(const FeatureMap& map, std::vector<double> inputs) {
  std::vector<double> out(map.size());
  map.evaluate(inputs, out);
  return out;
}

TEST(FeatureMap, MatchesHandValues) {
  const auto found = values(velocity_and_imbalance(), {6, 2, 0.4});

  EXPECT_DOUBLE_EQ(found[0], std::log(8.0) + 0.5 * 0.16);
  EXPECT_DOUBLE_EQ(found[1], 0.25);
  EXPECT_DOUBLE_EQ(found[2], 2 * (0.4 - 0.5));
}

TEST(FeatureMap, StaysFiniteForZeroNegativeAndHugeInputs) {
  for (const std::vector<double>& inputs : {std::vector<double>{0, 0, 0}, {-5, -5, 1}, {1e12, 1e12, 10}}) {
    for (double v : values(velocity_and_imbalance(), inputs)) EXPECT_TRUE(std::isfinite(v));
  }
}

TEST(FeatureMap, IsTheSameAfterSaveAndLoad) {
  io::TensorFile file;
  velocity_and_imbalance().save(file, "f");

  const FeatureMap loaded = FeatureMap::load(file, "f");

  EXPECT_EQ(values(loaded, {6, 2, 0.4}), values(velocity_and_imbalance(), {6, 2, 0.4}));
  EXPECT_EQ(loaded.features()[1].name, "imbalance");
}

TEST(FeatureMap, RefusesAnInputThatIsNotThere) {
  EXPECT_ERROR(InputError, "indices below 2",
               FeatureMap({{"x", {{Kind::value, 1, {{2}, {1}, 0}, {}, 0}}}}, 2));
}

// A fuzzer found that JSON's 2e199 became an index.
TEST(FeatureMap, RefusesAnIndexThatIsNoWholeNumber) {
  io::TensorFile good;
  velocity_and_imbalance().save(good, "map");
  const std::string text = good.text("map"), indices = R"("inputs":[0,1])";
  for (const char* index : {"2e199", "0.5", "4294967296", "-4294967295", "\"a\""}) {
    auto bad = text;
    bad.replace(bad.find(indices), indices.size(), R"("inputs":[0,)" + std::string(index) + "]");
    io::TensorFile file;
    file.set_text("map", bad);
    EXPECT_THROW((void)FeatureMap::load(file, "map"), InputError) << index;
  }
}

TEST(FeatureMap, RefusesBrokenText) {
  io::TensorFile file;
  file.set_text("f", R"({"n_inputs": 2, "features": [{"name": "x"}]})");

  EXPECT_ERROR(InputError, "broken description of derived inputs", FeatureMap::load(file, "f"));
}

}  // namespace
}  // namespace elrom::model
