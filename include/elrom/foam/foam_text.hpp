#pragma once
// How OpenFOAM writes: headers and lists, ascii.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace elrom::foam {

/// @param note one line for people; quotes and line breaks in it become blanks
[[nodiscard]] std::string header(std::string_view class_name, std::string_view location,
                                 std::string_view object, std::string_view note);

/// `N ( value value ... )`, a value a line, each as the shortest text that reads back to the same number.
[[nodiscard]] std::string list(std::span<const float> values);
/// The same of (x y z).
[[nodiscard]] std::string list(std::span<const float> x, std::span<const float> y, std::span<const float> z);

}  // namespace elrom::foam
