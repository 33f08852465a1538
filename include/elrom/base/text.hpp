#pragma once
// Small text helpers for messages and names.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace elrom::base {

[[nodiscard]] std::string trim(std::string_view text);
[[nodiscard]] std::vector<std::string> split(std::string_view text, char separator);
[[nodiscard]] std::string join(const std::vector<std::string>& parts, std::string_view separator);

/// The candidate nearest to `name` by edit distance, when near enough to be a likely slip of the pen.
[[nodiscard]] std::optional<std::string> closest_name(std::string_view name,
                                                      const std::vector<std::string>& candidates);

/// "did you mean 'x'?" or, without a near name, "known are: a, b, c" (at most ten are listed).
[[nodiscard]] std::string name_advice(std::string_view name, const std::vector<std::string>& candidates);

/// Shell-style match with '*' and '?', over the whole text.
[[nodiscard]] bool matches(std::string_view text, std::string_view pattern);

/// Shortest decimal text that reads back to the same double; independent of locale.
[[nodiscard]] std::string number(double value);
/// `value` with `digits` significant digits, for tables ("0.0123", "1.23e+06").
[[nodiscard]] std::string rounded(double value, int digits = 4);
/// Whole text as a finite or infinite double; nullopt when any character is left over. Independent of locale.
[[nodiscard]] std::optional<double> to_double(std::string_view text);
/// "12.3 s", "4 min 05 s", "2 h 10 min".
[[nodiscard]] std::string duration(double seconds);

}  // namespace elrom::base
