#pragma once
// Cases as a table in memory: what methods learn from. One field of all cases is resident at a time.
//
// Thread rule: plain data.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
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
  [[nodiscard]] std::size_t n_cases() const { return names.size(); }
  /// SHA-256 over all of it.
  [[nodiscard]] std::string key() const;
};

/// One field of all cases of a study; one is resident at a time.
struct FieldData {
  const CaseSet* cases = nullptr;
  FieldInfo info;
  MatrixF values;  //!< SI, (n_cases, n_cells)

  /// SHA-256 over all of it and of its cases: key of the stages that are given the whole.
  [[nodiscard]] std::string key() const;
};

/// Some cases of a field and nothing else of a study: what records are made of. All that can be read here is
/// part of its key.
class FieldRows {
 public:
  /// @param data must outlive it
  FieldRows(const FieldData& data, std::span<const std::size_t> rows)
      : data_(data), rows_(rows.begin(), rows.end()) {}

  [[nodiscard]] std::size_t n_cases() const { return rows_.size(); }
  [[nodiscard]] std::size_t n_inputs() const { return data_.cases->schema.size(); }
  [[nodiscard]] std::size_t n_planes() const { return data_.cases->mesh.n_planes; }
  [[nodiscard]] std::size_t n_columns() const { return data_.cases->mesh.n_columns; }
  [[nodiscard]] const FieldInfo& info() const { return data_.info; }
  [[nodiscard]] double load(std::size_t i) const { return data_.cases->loads[rows_[i]]; }
  [[nodiscard]] std::span<const double> inputs(std::size_t i) const;  ///< SI, (n_inputs())
  [[nodiscard]] std::span<const float> values(std::size_t i) const;   ///< SI, (n_planes() * n_columns())

  [[nodiscard]] std::string key() const;

 private:
  const FieldData& data_;
  std::vector<std::size_t> rows_;
};

}  // namespace elrom::field
