#pragma once
// Units that base/units.hpp does not know, read by UDUNITS: W/m2, W/(m2 K), kJ/kg, ppm, deg, mg/Nm3.
//
// The grammar is that of UDUNITS 2 (its manual, "Unit grammar"), with the spellings of the field: m2K and kgK
// behind a slash are products of the denominator, deg is the degree of angle, and Nm3 is the normal cubic
// metre. It is a base unit of its own, since what it weighs depends on the gas: Nm3/h stays a normal volume
// flow. What can be read in two ways, W/m2 K, is refused.
//
// Thread rule: any thread; calls wait for each other, since UDUNITS has one state.

#include <optional>
#include <string_view>

#include "elrom/base/units.hpp"

namespace elrom::units {

/// Nothing: UDUNITS does not know it, or it is no multiple (a logarithm, a date). The SI unit has one
/// spelling for each dimension: "J/kg" for kJ/kg. @throws InputError for a symbol that can be read in two
/// ways; SystemError when the list of units cannot be read
[[nodiscard]] std::optional<base::Unit> find(std::string_view symbol);

/// From now on base::unit() asks find().
void use_udunits();

}  // namespace elrom::units
