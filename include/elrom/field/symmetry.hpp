#pragma once
// Declared mirror symmetries of the furnace: how a mirror
// acts on inputs, on cells and on the sign of a field.

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/mesh.hpp"

namespace elrom::field {

/// As declared by a furnace or in study.toml: names only.
struct MirrorDeclaration {
  std::string name = "mirror";  ///< "left-right"
  char axis = 'y';              ///< the coordinate that changes its sense: 'x' or 'y'
  /// {"*_left", "*_right"}; the same number of '*' in both
  std::vector<std::pair<std::string, std::string>> swap;
  std::vector<std::string> complement;  ///< inputs q that become 1 - q
};

/// A declaration resolved on one schema and mesh. An involution: applying it twice changes nothing.
struct Mirror {
  std::string name;
  std::string axes;  ///< coordinates that change their sense: "" (identity), "x", "y" or "xy"
  std::vector<std::int32_t> input_from;  ///< mirrored[i] = offset[i] + sign[i] * values[input_from[i]]
  std::vector<double> input_sign, input_offset;
  std::vector<std::int32_t> cell_from;  ///< mirrored field [c] = field_sign * field[cell_from[c]], (n_cells)

  [[nodiscard]] std::vector<double> apply_to_inputs(std::span<const double> values) const;
  [[nodiscard]] double field_sign(Parity parity) const;
};

/// @throws InputError when no name matches a pattern, a name has no partner or two, or the mesh is not
/// symmetric to 1e-6 of its extent
[[nodiscard]] Mirror resolve(const MirrorDeclaration& declaration, const InputSchema& schema,
                             const Mesh& mesh);

/// The group that a list of mirrors generates (1, 2 or 4 elements), identity first; products are composed.
[[nodiscard]] std::vector<Mirror> symmetry_group(const std::vector<Mirror>& mirrors, std::size_t n_inputs,
                                                 std::size_t n_cells);

}  // namespace elrom::field
