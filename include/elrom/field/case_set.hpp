#pragma once
// Cases as a table in memory: what methods learn from. One field of all cases is resident at a time.
//
// Thread rule: plain data.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/furnace.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/field/symmetry.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::field {

/// What all fields of a study share.
struct CaseSet {
  Mesh mesh;
  InputSchema schema;
  std::vector<std::string> names;  //!< (n_cases)
  std::vector<double> loads;       //!< (n_cases)
  MatrixD inputs;                  //!< SI, (n_cases, n_inputs)
  std::vector<Mirror> mirrors;     ///< declared and switched on; empty: none
  std::optional<Furnace> furnace;  ///< where somebody described it
  [[nodiscard]] std::size_t n_cases() const { return names.size(); }
};

/// One field of all cases of a study; one is resident at a time.
struct FieldData {
  const CaseSet* cases = nullptr;
  FieldInfo info;
  MatrixF values;  //!< SI, (n_cases, n_cells)
};

/// SHA-256 over inputs, values, loads and mesh of these cases: what every result of theirs depends on.
[[nodiscard]] std::string data_digest(const FieldData& data, std::span<const std::size_t> cases);

}  // namespace elrom::field
