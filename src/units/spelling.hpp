#pragma once
// The field's spelling of a unit as UDUNITS writes it.

#include <string>
#include <string_view>

namespace elrom::units {

/// What Nm3 is to UDUNITS, in which names do not end in a digit.
inline constexpr const char* normal_cubic_metre = "normal_cubic_metre";

/// "W/m2K" -> "W/(m2 K)", "deg" -> "degree", "Nm3/h" -> "normal_cubic_metre/h"
/// @throws InputError for "W/m2 K", which is W/(m2 K) to an engineer and W K/m2 to UDUNITS
[[nodiscard]] std::string udunits_spelling(std::string_view symbol);

}  // namespace elrom::units
