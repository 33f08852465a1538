#pragma once
// A case as a JSON or TOML tree gives it, before a schema is applied.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"

namespace elrom::field::detail {

struct RawCase {
  std::string name;
  std::string where;                                   ///< "cases.json, case 'load_064'"
  std::optional<std::pair<std::string, double>> load;  ///< key as written, value
  std::vector<std::pair<std::string, double>> inputs;  ///< "name [unit]", value
};

/// Keys of a case object beside `inputs` are checked by this: case, load, load [%]. @throws InputError
void check_case_key(const std::string& key, const std::string& where);
[[nodiscard]] CaseInputs resolve(const RawCase& raw, const InputSchema& schema);

}  // namespace elrom::field::detail
