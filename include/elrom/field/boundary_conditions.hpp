#pragma once
// Boundary conditions: names, units and values of a case's inputs. SI inside; the user's units in files.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::field {

struct InputInfo {
  std::string name;          ///< "primary_air"
  std::string unit;          ///< SI: "kg/s", "kg", "m", "K", "1"
  std::string display_unit;  ///< as the user writes it: "t", "um", "degC"
  bool operator==(const InputInfo&) const = default;
};

/// The ordered list of inputs that a store or a bundle was made with.
class InputSchema {
 public:
  InputSchema() = default;
  explicit InputSchema(std::vector<InputInfo> inputs) : inputs_(std::move(inputs)) {}
  [[nodiscard]] std::size_t size() const { return inputs_.size(); }
  [[nodiscard]] const InputInfo& operator[](std::size_t i) const { return inputs_[i]; }
  [[nodiscard]] const std::vector<InputInfo>& inputs() const { return inputs_; }
  [[nodiscard]] std::vector<std::string> names() const;
  /// @throws InputError with the nearest name
  [[nodiscard]] std::size_t index_of(std::string_view name) const;
  bool operator==(const InputSchema&) const = default;

 private:
  std::vector<InputInfo> inputs_;
};

/// One case to predict or to learn from.
struct CaseInputs {
  std::string name;
  double load = 0;             ///< fraction of full load; NaN: not given
  std::vector<double> values;  ///< SI, in the schema's order, (n_inputs)
};

/// The schema that a cases file declares by its headings (`name [unit]`), in the file's order.
[[nodiscard]] InputSchema read_schema(const std::filesystem::path& cases_csv);

/// Reads a table of cases: columns `case`, `load` (optional) and every input of `schema` as `name [unit]`, in
/// any order. Values come back in SI. Also takes JSON ({"case": ..., "load": ..., "inputs": {"primary_air
/// [kg/s]": 161.1, ...}} or a list of such) and TOML (the same keys; [[cases]] for several), told apart by
/// the file's ending.
/// @throws InputError for a missing or unknown input (with the nearest name), a unit of another dimension, a
///         value that is no finite number, a repeated case name; the message says file, line and column
[[nodiscard]] std::vector<CaseInputs> read_cases(const std::filesystem::path& path,
                                                 const InputSchema& schema);

/// Applies "name=value" or "name=value unit" (display unit when none is given) to a case. @throws UsageError
/// / InputError
void apply_setting(CaseInputs& inputs, std::string_view setting, const InputSchema& schema);

}  // namespace elrom::field
