#pragma once
// Units at the edges: SI inside the library, the user's units in files, on the command line and in reports.

#include <optional>
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

/// "315um", "315 um", "1e-3" -> number and symbol; symbol empty when
/// there is none. Nothing: the text does not begin with a finite number.
struct Quantity {
  double value;
  std::string symbol;
};
[[nodiscard]] std::optional<Quantity> split_quantity(std::string_view text);

/// The same in SI; without a symbol it is in SI already. @param si the SI unit of the dimension wanted, "m"
/// @throws InputError for no number, an unknown unit, a unit of another dimension
[[nodiscard]] double quantity(std::string_view text, std::string_view si);

/// "0:20 m/s", "300um:0.4mm"; one value alone is both ends. A unit of the second end is the first's too where
/// that has none. Whether the ends are the right way round is not asked. @throws InputError as quantity()
struct Interval {
  double low, high;
};
[[nodiscard]] Interval interval(std::string_view text, std::string_view si);

}  // namespace elrom::base
