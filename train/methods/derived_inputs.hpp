#pragma once
// The derived inputs of the kernel method, from the schema's units and names and the declared mirrors;
// internal to methods.

#include <span>
#include <vector>

#include "elrom/methods/method.hpp"
#include "elrom/model/feature_map.hpp"
#include "symmetry_classes.hpp"

namespace elrom::methods {

struct DerivedInputs {
  model::FeatureMap map;
  std::vector<std::size_t> class_of;  ///< index of the symmetry class of each feature
  /// Names of the features that each quantity could be, which is positive and varies by more than a factor of
  /// two: itself, its logarithm, its inverse. One of them is in the map.
  std::vector<std::vector<std::string>> forms = {};
  /// Logarithms of what a field's magnitude may follow, over their means: all gas, and every other positive
  /// quantity that has a unit or varies by more than a factor of two.
  std::vector<model::Feature> scales = {};
};

/// Symmetric features: where the schema has gas flows [kg/s], a temperature [K] and a diameter [m], the gas
/// velocity over the solids' Sauter diameter (all gas, and the largest inlet alone), the other inlets' shares
/// of the gas, and logarithms of what is positive; otherwise the inputs themselves. Inputs that mirrors
/// exchange enter by their sum. Antisymmetric features: the imbalance of exchanged inputs relative to their
/// mean. Features that do not vary over the given cases are left out.
/// @param wanted names among `forms`, which are taken instead of the usual ones
[[nodiscard]] DerivedInputs derive_inputs(const field::CaseSet& cases, std::span<const std::size_t> rows,
                                          const std::vector<SymmetryClass>& classes,
                                          std::span<const std::string> wanted = {});

}  // namespace elrom::methods
