#pragma once
// The cases to predict: a table, some of its rows, changed by settings and sweeps; or one case made of
// settings alone. Impossible inputs are refused here.

#include <cstddef>
#include <optional>
#include <vector>

#include "elrom/base/units.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/fields/arguments.hpp"

namespace elrom::fields {

struct CaseList {
  /// Where a case comes from.
  struct Origin {
    std::size_t base = 0;              ///< the case it was made from; its own number: none
    std::vector<std::size_t> changed;  ///< inputs that a sweep gave it
  };
  /// An input that a setting or a sweep moves.
  struct Moved {
    std::size_t input = 0;
    const base::Unit* unit = nullptr;  ///< that its values were given in
  };
  std::vector<field::CaseInputs> cases;
  std::vector<Origin> origins;  //!< (cases)
  std::vector<Moved> swept;     //!< in the order of the sweeps
};

/// @throws UsageError (no such case, an input not given, a sweep that is none), InputError (the table, an
/// impossible input)
[[nodiscard]] CaseList case_list(const Arguments& arguments, const field::InputSchema& schema);

}  // namespace elrom::fields
