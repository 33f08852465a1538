#include "elrom/base/units.hpp"

#include <algorithm>
#include <array>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::base {
namespace {

const std::vector<Unit>& table() {
  static const std::vector<Unit> units = {
      {"1", "1"},
      {"%", "1", 0.01},
      {"kg/s", "kg/s"},
      {"t/h", "kg/s", 1000.0 / 3600.0},
      {"kg/h", "kg/s", 1.0 / 3600.0},
      {"g/s", "kg/s", 1e-3},
      {"kg", "kg"},
      {"t", "kg", 1000.0},
      {"g", "kg", 1e-3},
      {"m", "m"},
      {"mm", "m", 1e-3},
      {"um", "m", 1e-6},
      {"cm", "m", 1e-2},
      {"K", "K"},
      {"degC", "K", 1.0, 273.15},
      {"Pa", "Pa"},
      {"hPa", "Pa", 100.0},
      {"mbar", "Pa", 100.0},
      {"kPa", "Pa", 1e3},
      {"bar", "Pa", 1e5},
      {"MPa", "Pa", 1e6},
      {"m/s", "m/s"},
      {"cm/s", "m/s", 1e-2},
      {"km/h", "m/s", 1.0 / 3.6},
      {"s", "s"},
      {"min", "s", 60.0},
      {"h", "s", 3600.0},
      {"m3", "m3"},
      {"kg/m3", "kg/m3"},
      {"W", "W"},
      {"MW", "W", 1e6},
  };
  return units;
}

}  // namespace

const Unit& unit(std::string_view symbol) {
  // Spellings that mean the same and need no error.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> aliases{
      {{"-", "1"}, {"", "1"}, {"C", "degC"}, {"\u00b0C", "degC"}, {"\u00b5m", "um"}}};
  for (const auto& [spelling, canonical] : aliases) {
    if (symbol == spelling) symbol = canonical;
  }
  const auto& units = table();
  const auto found =
      std::find_if(units.begin(), units.end(), [&](const Unit& u) { return u.symbol == symbol; });
  if (found != units.end()) return *found;
  std::vector<std::string> symbols;
  for (const auto& u : units) symbols.push_back(u.symbol);
  throw InputError(
      {.what = "unknown unit '" + std::string(symbol) + "'", .advice = "known are: " + join(symbols, ", ")});
}

std::vector<std::string> units_of(std::string_view si) {
  std::vector<std::string> symbols;
  for (const auto& u : table()) {
    if (u.si == si) symbols.push_back(u.symbol);
  }
  return symbols;
}

NameAndUnit split_unit(std::string_view heading) {
  const auto text = trim(heading);
  const auto open = text.find('[');
  if (open == std::string::npos || text.back() != ']') return {text, ""};
  return {trim(text.substr(0, open)), trim(std::string_view(text).substr(open + 1, text.size() - open - 2))};
}

}  // namespace elrom::base
