#include "elrom/base/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

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
      {"nm", "m", 1e-9},
      {"K", "K"},
      {"degC", "K", 1.0, 273.15},
      {"Pa", "Pa"},
      {"hPa", "Pa", 100.0},
      {"mbar", "Pa", 100.0},
      {"kPa", "Pa", 1e3},
      {"bar", "Pa", 1e5},
      {"MPa", "Pa", 1e6},
      {"GPa", "Pa", 1e9},
      {"m/s", "m/s"},
      {"cm/s", "m/s", 1e-2},
      {"mm/s", "m/s", 1e-3},
      {"km/h", "m/s", 1.0 / 3.6},
      {"s", "s"},
      {"ms", "s", 1e-3},
      {"us", "s", 1e-6},
      {"min", "s", 60.0},
      {"h", "s", 3600.0},
      {"m3", "m3"},
      {"kg/m3", "kg/m3"},
      {"g/cm3", "kg/m3", 1e3},
      {"N/m", "N/m"},
      {"N/mm", "N/m", 1e3},
      {"kN/m", "N/m", 1e3},
      {"rad/s", "rad/s"},
      {"W", "W"},
      {"MW", "W", 1e6},
  };
  return units;
}

}  // namespace

const Unit& unit(std::string_view symbol) {
  // Spellings that mean the same and need no error.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> aliases{
      {{"-", "1"}, {"", "1"}, {"C", "degC"}, {"\u00b0C", "degC"}, {"\u00b5m", "um"}, {"\u00b5s", "us"}}};
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

std::optional<Quantity> split_quantity(std::string_view text) {
  const auto whole = trim(text);
  double value = 0;
  const auto* const begin = whole.data() + (whole.starts_with('+') ? 1 : 0);
  const auto* const end = whole.data() + whole.size();
  const auto [stop, fault] = std::from_chars(begin, end, value);
  if (fault != std::errc{} || !std::isfinite(value)) return std::nullopt;
  return Quantity{value, trim(std::string_view(stop, end))};
}

namespace {

Quantity quantity_in(std::string_view text) {
  if (const auto found = split_quantity(text)) return *found;
  throw InputError({.what = "no finite number",
                    .found = "'" + std::string(text) + "'",
                    .expected = "a number, with or without a unit"});
}

double si_of(const Quantity& given, std::string_view si) {
  if (given.symbol.empty()) return given.value;
  const auto& known = unit(given.symbol);
  if (known.si != si)
    throw InputError({.what = "a unit of another dimension",
                      .found = "'" + given.symbol + "'",
                      .expected = join(units_of(si), ", ")});
  return known.to_si(given.value);
}

}  // namespace

double quantity(std::string_view text, std::string_view si) { return si_of(quantity_in(text), si); }

Interval interval(std::string_view text, std::string_view si) {
  const auto sides = split(text, ':');
  if (sides.size() > 2)
    throw InputError({.what = "no range", .found = "'" + std::string(text) + "'", .expected = "low:high"});
  auto low = quantity_in(sides.front());
  const auto high = quantity_in(sides.back());
  if (low.symbol.empty()) low.symbol = high.symbol;
  return {si_of(low, si), si_of(high, si)};
}

}  // namespace elrom::base
