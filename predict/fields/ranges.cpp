#include "ranges.hpp"

#include <charconv>
#include <optional>
#include <set>
#include <string>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::fields {
namespace {

[[noreturn]] void refuse_planes(std::string_view text, std::size_t n_planes) {
  throw UsageError(
      {.what = "--planes cannot be read",
       .found = "'" + std::string(text) + "'",
       .expected = "such as 7, 0:10 or 0:10,20,30: with planes from 0 to " + std::to_string(n_planes - 1)});
}

std::optional<std::size_t> whole_number(std::string_view text) {
  std::size_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::vector<std::int32_t> parse_planes(std::string_view text, std::size_t n_planes) {
  std::set<std::int32_t> planes;
  if (text.empty()) return {};
  for (const auto& part : base::split(text, ',')) {
    const auto sides = base::split(base::trim(part), ':');
    const bool range = sides.size() == 2;
    const auto first = range && sides[0].empty() ? std::optional<std::size_t>(0) : whole_number(sides[0]);
    std::optional<std::size_t> end = first ? std::optional(*first + 1) : std::nullopt;
    if (range) end = sides[1].empty() ? std::optional(n_planes) : whole_number(sides[1]);
    if (sides.size() > 2 || !first || !end || *first >= *end || *end > n_planes)
      refuse_planes(text, n_planes);
    for (std::size_t plane = *first; plane < *end; ++plane) planes.insert(static_cast<std::int32_t>(plane));
  }
  return {planes.begin(), planes.end()};
}

Box parse_box(std::string_view text) {
  const auto refuse = [&] {
    throw UsageError({.what = "--region cannot be read",
                      .found = "'" + std::string(text) + "'",
                      .expected = "x0:x1,y0:y1,z0:z1 in m, such as :,0:13.8,0:10"});
  };
  Box box;
  const auto axes = base::split(text, ',');
  if (axes.size() != 3) refuse();
  for (std::size_t axis = 0; axis < axes.size() && axis < 3; ++axis) {
    const auto sides = base::split(base::trim(axes[axis]), ':');
    if (sides.size() != 2) refuse();
    for (std::size_t side = 0; side < 2; ++side) {
      if (sides[side].empty()) continue;
      const auto value = base::to_double(sides[side]);
      if (!value) refuse();
      (side == 0 ? box.low : box.high)[axis] = *value;
    }
    if (!(box.low[axis] < box.high[axis])) refuse();
  }
  return box;
}

}  // namespace elrom::fields
