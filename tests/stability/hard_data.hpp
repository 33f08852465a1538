#pragma once
// Small data sets, each hard in its own way: what breaks
// statistics, scalers, Gaussian processes and networks.

#include <functional>
#include <string>
#include <vector>

#include "elrom/methods/method.hpp"

namespace elrom::stability {

struct HardData {
  std::string name;         ///< "constant_columns"
  std::string description;  ///< one line for the table
  field::CaseSet cases;
  std::vector<field::FieldInfo> fields;
  std::vector<MatrixF> values;   //!< of each field, SI, (n_cases, n_cells)
  bool must_be_refused = false;  ///< holds cells that are not finite: no store may take it
  /// The cases fill so little of their box that its corners are far from all
  bool corners_are_outside = false;
};

/// Every hard case that is made of data.
[[nodiscard]] std::vector<HardData> all_hard_data();

}  // namespace elrom::stability
