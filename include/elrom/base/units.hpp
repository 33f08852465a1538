#pragma once
// Units at the edges: SI inside the library, the user's units in files, on the command line and in reports.
//
// A table of common units is always there. A program may add a source of others (units/udunits.hpp), and a
// store or a bundle brings those that its own inputs came in, so that whoever reads it needs no source.
//
// Thread rule: any thread.

#include <functional>
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

/// The reference stays good. @throws InputError for an unknown symbol, with the known ones
[[nodiscard]] const Unit& unit(std::string_view symbol);
/// The symbols known so far of the dimension whose SI unit is `si`; at least `si` itself.
[[nodiscard]] std::vector<std::string> units_of(std::string_view si);

/// Whether every ELROM knows the symbol; a file that uses another carries its factor and offset.
[[nodiscard]] bool is_common_unit(std::string_view symbol);
/// Takes in a unit that a file brings, and the SI unit it names. @throws InputError for no symbol, a factor
/// that is no finite number or 0, and a symbol that means something else already
void know_unit(const Unit& unit);
/// Where unit() asks for symbols that are not known yet; empty: nowhere.
using UnitSource = std::function<std::optional<Unit>(std::string_view symbol)>;
void set_unit_source(UnitSource source);

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

/// In SI; without a symbol it is in SI already. @param si the SI unit of the dimension wanted, "m"
/// @throws InputError for an unknown unit, a unit of another dimension
[[nodiscard]] double to_si(const Quantity& given, std::string_view si);
/// The same of a text. @throws InputError for no number, too
[[nodiscard]] double quantity(std::string_view text, std::string_view si);

/// "0:20 m/s", "300um:0.4mm"; one value alone is both ends. A unit of the second end is the first's too where
/// that has none. Whether the ends are the right way round is not asked. @throws InputError as quantity()
struct Interval {
  double low, high;
};
[[nodiscard]] Interval interval(std::string_view text, std::string_view si);

}  // namespace elrom::base
