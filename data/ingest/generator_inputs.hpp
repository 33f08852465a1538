#pragma once
// Inputs of generated cases: what each means for the flow, and the design that fills them.

#include <string>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/furnace.hpp"

namespace elrom::ingest {

/// What an input does in the generator.
enum class Role { gas_inlet, inventory, diameter, spread, temperature, left_share };

/// One input: its value at 40 % and at 100 % load (SI), its own deviation, and where an inlet lies.
struct GeneratorInput {
  field::InputInfo info;
  Role role = Role::gas_inlet;
  double at_low = 0, at_full = 0;
  double deviation = 0.2;  ///< relative, uniform within +- this
  double x = 0, y = 0;     ///< of an inlet: -1 to 1 across the section (front to rear, left to right)
  double height = 0;       ///< share of the furnace's height
};

/// The first n of the shipped cases' inputs; beyond 26, auxiliary inlets at places drawn from the seed.
[[nodiscard]] std::vector<GeneratorInput> generator_inputs(std::size_t n, base::Seed seed);

/// The furnace that cases of these inputs are made of: an opening a gas inlet, the outlet at the top, mirrors
/// and names of held-out cases as in the shipped one.
[[nodiscard]] field::Furnace generator_furnace(const std::vector<GeneratorInput>& inputs);

/// One case's place in the design.
struct DesignPoint {
  double load = 0;
  std::vector<double> values;  ///< SI, (n_inputs)
};

/// Latin hypercube of n cases over the load (0.40 to 1.02) and each input's deviation.
[[nodiscard]] std::vector<DesignPoint> latin_design(std::size_t n, const std::vector<GeneratorInput>& inputs,
                                                    base::Seed seed);
/// The same with given loads.
[[nodiscard]] std::vector<DesignPoint> design_at(const std::vector<double>& loads,
                                                 const std::vector<GeneratorInput>& inputs, base::Seed seed);

}  // namespace elrom::ingest
