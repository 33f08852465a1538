#include "generator_inputs.hpp"

#include <fmt/format.h>

#include <numeric>

#include "elrom/field/mesh.hpp"

namespace elrom::ingest {

namespace {

GeneratorInput inlet(const char* name, double low, double full, double deviation, double x, double y,
                     double height) {
  return {.info = {name, "kg/s", "kg/s"},
          .at_low = low,
          .at_full = full,
          .deviation = deviation,
          .x = x,
          .y = y,
          .height = height};
}

GeneratorInput state(const char* name, const char* si, const char* display, Role role, double low,
                     double full, double deviation) {
  return {.info = {name, si, display}, .role = role, .at_low = low, .at_full = full, .deviation = deviation};
}

// Values near those of the shipped cases.
std::vector<GeneratorInput> shipped_inputs() {
  return {
      inlet("primary_air", 150, 213, 0.07, 0, 0, 0),
      inlet("secondary_front_lower_left", 8.5, 20, 0.2, -1, -0.5, 0.06),
      inlet("secondary_front_lower_right", 8.5, 20, 0.2, -1, 0.5, 0.06),
      inlet("secondary_front_upper_left", 8.5, 20, 0.25, -1, -0.5, 0.11),
      inlet("secondary_front_upper_right", 8.5, 20, 0.25, -1, 0.5, 0.11),
      inlet("secondary_rear_lower_left", 8.5, 20, 0.2, 1, -0.5, 0.06),
      inlet("secondary_rear_lower_right", 8.5, 20, 0.2, 1, 0.5, 0.06),
      inlet("secondary_rear_upper_left", 8.5, 20, 0.25, 1, -0.5, 0.11),
      inlet("secondary_rear_upper_right", 8.5, 20, 0.25, 1, 0.5, 0.11),
      inlet("fuel_front_left", 2.3, 5.7, 0.25, -1, -0.7, 0.04),
      inlet("fuel_front_right", 2.3, 5.7, 0.25, -1, 0.7, 0.04),
      inlet("fuel_rear_left", 2.3, 5.7, 0.25, 1, -0.7, 0.04),
      inlet("fuel_rear_right", 2.3, 5.7, 0.25, 1, 0.7, 0.04),
      inlet("burner_left", 2.0, 4.1, 0.25, 0, -1, 0.08),
      inlet("burner_right", 2.0, 4.1, 0.25, 0, 1, 0.08),
      inlet("return_front_left", 2.1, 5.0, 0.25, -1, -0.3, 0.03),
      inlet("return_front_right", 2.1, 5.0, 0.25, -1, 0.3, 0.03),
      inlet("return_rear_left", 2.1, 5.0, 0.25, 1, -0.3, 0.03),
      inlet("return_rear_right", 2.1, 5.0, 0.25, 1, 0.3, 0.03),
      inlet("intrex_left", 2.2, 5.8, 0.25, 0, -1, 0.02),
      inlet("intrex_right", 2.2, 5.8, 0.25, 0, 1, 0.02),
      state("solids_inventory", "kg", "t", Role::inventory, 1.0e5, 1.0e5, 0.22),
      state("solids_d50", "m", "um", Role::diameter, 320e-6, 320e-6, 0.18),
      state("solids_spread", "1", "1", Role::spread, 0.4, 0.4, 0.3),
      state("gas_temperature", "K", "degC", Role::temperature, 1050, 1170, 0.01),
      state("return_left_fraction", "1", "1", Role::left_share, 0.5, 0.5, 0.15),
  };
}

// Stratified over [0, 1): one draw in each of n equal parts, in random order.
std::vector<double> strata(std::size_t n, base::Random& random) {
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  random.shuffle(order);
  std::vector<double> draws;
  for (const auto part : order)
    draws.push_back((static_cast<double>(part) + random.uniform()) / static_cast<double>(n));
  return draws;
}

}  // namespace

std::vector<GeneratorInput> generator_inputs(std::size_t n, base::Seed seed) {
  auto inputs = shipped_inputs();
  base::Random random(seed.derive("auxiliary inlets"));
  for (std::size_t i = inputs.size(); i < n; ++i) {
    auto one = inlet("", 1, 3, 0.25, 0, 0, random.uniform(0.02, 0.5));
    one.info.name = fmt::format("auxiliary_{:02}", i - 25);
    const bool side = random.uniform() < 0.5;
    (side ? one.y : one.x) = random.uniform() < 0.5 ? -1 : 1;
    (side ? one.x : one.y) = random.uniform(-0.8, 0.8);
    inputs.push_back(one);
  }
  inputs.resize(n);
  return inputs;
}

field::Furnace generator_furnace(const std::vector<GeneratorInput>& inputs) {
  constexpr double height = field::TaperedFurnace{}.height_m, solid_density = 2400;
  field::Furnace furnace{.name = "generated",
                         .solid_density = solid_density,
                         .packing_limit = field::packing_limit,
                         .outlet_low_m = height,
                         .held_out = {"load_*", "rep*"},
                         .repeats = {"rep*"}};
  for (const auto& input : inputs) {
    if (input.role != Role::gas_inlet) continue;
    const double at = input.height * height;
    furnace.openings.push_back({.inputs = input.info.name, .low_m = at, .high_m = at});
  }
  furnace.mirrors = {{.name = "left-right",
                      .axis = 'y',
                      .swap = {{"*_left", "*_right"}},
                      .complement = {"return_left_fraction"}},
                     {.name = "front-rear",
                      .axis = 'x',
                      .swap = {{"secondary_front_*", "secondary_rear_*"},
                               {"fuel_front_*", "fuel_rear_*"},
                               {"return_front_*", "return_rear_*"}}}};
  return furnace;
}

std::vector<DesignPoint> design_at(const std::vector<double>& loads,
                                   const std::vector<GeneratorInput>& inputs, base::Seed seed) {
  std::vector<DesignPoint> points(loads.size());
  for (std::size_t c = 0; c < loads.size(); ++c) points[c].load = loads[c];
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    base::Random random(seed.derive(i));
    const auto draws = strata(loads.size(), random);
    for (std::size_t c = 0; c < loads.size(); ++c) {
      constexpr double low_load = 0.4;
      const double grown = (loads[c] - low_load) / (1 - low_load);
      const double typical = inputs[i].at_low + (inputs[i].at_full - inputs[i].at_low) * grown;
      points[c].values.push_back(typical * (1 + inputs[i].deviation * (2 * draws[c] - 1)));
    }
  }
  return points;
}

std::vector<DesignPoint> latin_design(std::size_t n, const std::vector<GeneratorInput>& inputs,
                                      base::Seed seed) {
  constexpr double lowest = 0.40, highest = 1.02;
  base::Random random(seed.derive("load"));
  std::vector<double> loads;
  for (const double draw : strata(n, random)) loads.push_back(lowest + (highest - lowest) * draw);
  return design_at(loads, inputs, seed.derive("deviations"));
}

}  // namespace elrom::ingest
