#include "elrom/base/units.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <mutex>

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

std::string in_lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return result;
}

/// Without what is not common.
const Unit* common(std::string_view symbol) {
  const auto& units = table();
  const auto found = std::ranges::find(units, symbol, &Unit::symbol);
  return found == units.end() ? nullptr : &*found;
}

/// What files and the source brought.
struct Further {
  std::mutex mutex;
  std::map<std::string, Unit, std::less<>> units;
  UnitSource source;
};
Further& further() {
  static Further units;
  return units;
}

/// Null: unknown.
const Unit* further_unit(std::string_view symbol) {
  auto& [mutex, units, source] = further();
  const std::lock_guard lock(mutex);
  const auto found = units.find(symbol);
  if (found != units.end()) return &found->second;
  auto made = source ? source(symbol) : std::nullopt;
  return made ? &units.emplace(symbol, *std::move(made)).first->second : nullptr;
}

/// With its words as the table has them: "kg/sec" is "kg/s", "KG/S" is "kg/s" in other letters.
std::string in_table_words(std::string_view symbol) {
  static const std::map<std::string, std::string, std::less<>> words{
      {"sec", "s"},   {"second", "s"},     {"seconds", "s"},   {"hr", "h"},       {"hour", "h"},
      {"hours", "h"}, {"minute", "min"},   {"minutes", "min"}, {"tph", "t/h"},    {"ton", "t"},
      {"tonne", "t"}, {"kgps", "kg/s"},    {"micron", "um"},   {"microns", "um"}, {"metre", "m"},
      {"meter", "m"}, {"celsius", "degc"}, {"kelvin", "k"},    {"percent", "%"},  {"cbm", "m3"},
      {"m^3", "m3"}};
  std::vector<std::string> parts;
  for (const auto& part : split(in_lower_case(symbol), '/')) {
    const auto found = words.find(trim(part));
    parts.push_back(found == words.end() ? trim(part) : found->second);
  }
  return join(parts, "/");
}

/// The unit that an unknown symbol was meant for. Nothing that is only near: "barg" is no bar.
std::string advice_for(std::string_view symbol) {
  const auto meant = in_table_words(symbol);
  std::vector<std::string> symbols;
  for (const auto& u : table()) {
    if (in_lower_case(u.symbol) == meant) return "did you mean '" + u.symbol + "'?";
    symbols.push_back(u.symbol);
  }
  return "known are: " + join(symbols, ", ");
}

/// Versions of a source may round differently.
bool same(const Unit& a, const Unit& b) {
  const auto near = [](double x, double y) { return std::abs(x - y) <= 1e-9 * std::abs(x); };
  return a.si == b.si && near(a.factor, b.factor) && near(a.offset, b.offset);
}

}  // namespace

bool is_common_unit(std::string_view symbol) { return common(symbol) != nullptr; }

void know_unit(const Unit& unit) {
  if (unit.symbol != unit.si) know_unit({unit.si, unit.si});
  if (unit.symbol.empty() || unit.si.empty() || !std::isfinite(unit.factor) || unit.factor == 0 ||
      !std::isfinite(unit.offset))
    throw InputError({.what = "no unit",
                      .found = "'" + unit.symbol + "': value * " + number(unit.factor) + " + " +
                               number(unit.offset) + " in '" + unit.si + "'"});
  const auto* known = common(unit.symbol);
  auto& [mutex, units, source] = further();
  const std::lock_guard lock(mutex);
  if (known == nullptr) known = &units.emplace(unit.symbol, unit).first->second;
  if (!same(*known, unit))
    throw InputError({.what = "unit '" + unit.symbol + "' means something else",
                      .found = "factor " + number(unit.factor) + " to " + unit.si,
                      .expected = "factor " + number(known->factor) + " to " + known->si});
}

void set_unit_source(UnitSource source) {
  const std::lock_guard lock(further().mutex);
  further().source = std::move(source);
}

const Unit& unit(std::string_view symbol) {
  // Spellings that mean the same and need no error.
  constexpr std::array<std::pair<std::string_view, std::string_view>, 6> aliases{
      {{"-", "1"}, {"", "1"}, {"C", "degC"}, {"\u00b0C", "degC"}, {"\u00b5m", "um"}, {"\u00b5s", "us"}}};
  for (const auto& [spelling, canonical] : aliases) {
    if (symbol == spelling) symbol = canonical;
  }
  if (const auto* known = common(symbol)) return *known;
  if (const auto* known = further_unit(symbol)) return *known;
  throw InputError({.what = "unknown unit '" + std::string(symbol) + "'", .advice = advice_for(symbol)});
}

std::vector<std::string> units_of(std::string_view si) {
  std::vector<std::string> symbols;
  for (const auto& u : table()) {
    if (u.si == si) symbols.push_back(u.symbol);
  }
  auto& [mutex, units, source] = further();
  const std::lock_guard lock(mutex);
  for (const auto& [symbol, unit] : units) {
    if (unit.si == si) symbols.push_back(symbol);
  }
  if (symbols.empty()) symbols.emplace_back(si);
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

}  // namespace

double to_si(const Quantity& given, std::string_view si) {
  if (given.symbol.empty()) return given.value;
  const auto& known = unit(given.symbol);
  if (known.si != si)
    throw InputError({.what = "a unit of another dimension",
                      .found = "'" + given.symbol + "'",
                      .expected = join(units_of(si), ", ")});
  return known.to_si(given.value);
}

double quantity(std::string_view text, std::string_view si) { return to_si(quantity_in(text), si); }

Interval interval(std::string_view text, std::string_view si) {
  const auto sides = split(text, ':');
  if (sides.size() > 2)
    throw InputError({.what = "no range", .found = "'" + std::string(text) + "'", .expected = "low:high"});
  auto low = quantity_in(sides.front());
  const auto high = quantity_in(sides.back());
  if (low.symbol.empty()) low.symbol = high.symbol;
  return {to_si(low, si), to_si(high, si)};
}

}  // namespace elrom::base
