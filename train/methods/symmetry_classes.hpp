#pragma once
// Parts of a field that a mirror either keeps or turns into their negative; internal to methods.

#include <span>
#include <string>
#include <vector>

#include "elrom/methods/method.hpp"
#include "elrom/model/feature_map.hpp"

namespace elrom::methods {

/// One sign a mirror: +1 keeps, -1 negates. Without mirrors there is one class, the whole field.
struct SymmetryClass {
  std::vector<int> signs;
  [[nodiscard]] bool symmetric() const;
};

/// All combinations of signs, the symmetric one first.
[[nodiscard]] std::vector<SymmetryClass> symmetry_classes(std::size_t n_mirrors);

/// Projection of one input on a class, product over mirrors of (1 + sign * M) / 2, as a linear form; all
/// weights are zero when the class has no part in that input.
[[nodiscard]] model::LinearForm project_input(const field::CaseSet& cases, std::size_t input,
                                              const SymmetryClass& symmetry);

/// Inputs that mirrors exchange, each list ascending; inputs on their own make lists of one.
[[nodiscard]] std::vector<std::vector<std::size_t>> input_orbits(const field::CaseSet& cases);

}  // namespace elrom::methods
