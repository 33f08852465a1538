#pragma once
// Units at the edges: SI inside the library, the user's units in files, on the command line and in reports.

#include <string>
#include <string_view>
#include <vector>

namespace elrom::base {

/// value_SI = value * factor + offset
struct Unit {
  std::string symbol;  ///< "t/h"
  std::string si;      ///< "kg/s": the SI unit of the same dimension
  double factor = 1;
  double offset = 0;

  [[nodiscard]] double to_si(double value) const { return value * factor + offset; }
  [[nodiscard]] double from_si(double value) const { return (value - offset) / factor; }
};

/// @throws InputError for an unknown symbol, with the known ones
[[nodiscard]] const Unit& unit(std::string_view symbol);
/// All symbols of the dimension whose SI unit is `si`.
[[nodiscard]] std::vector<std::string> units_of(std::string_view si);

/// "primary_air [kg/s]" -> name and symbol; symbol empty when there is no bracket.
struct NameAndUnit {
  std::string name, symbol;
};
[[nodiscard]] NameAndUnit split_unit(std::string_view heading);

}  // namespace elrom::base
