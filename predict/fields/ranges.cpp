#include "elrom/fields/ranges.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::fields {
namespace {

/// No mesh has more; a list of so many would still fit the memory.
constexpr std::int32_t most_planes = 1'000'000;

std::optional<std::int32_t> whole_number(std::string_view text) {
  std::int32_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc{} || end != text.data() + text.size() || value < 0 || value > most_planes)
    return std::nullopt;
  return value;
}

}  // namespace

field::Planes parse_planes(std::string_view text) {
  const auto refuse = [&] {
    throw UsageError({.what = "--planes cannot be read",
                      .found = "'" + std::string(text) + "'",
                      .expected = "such as 7, 0:10 or 0:10,20,30:"});
  };
  std::vector<std::int32_t> numbers;
  std::optional<std::int32_t> open_from;
  for (const auto& part : base::split(text, ',')) {
    const auto sides = base::split(base::trim(part), ':');
    const bool range = sides.size() == 2, open = range && sides[1].empty();
    const auto first = range && sides[0].empty() ? std::optional(0) : whole_number(sides[0]);
    auto end = first ? std::optional(*first + 1) : std::nullopt;
    if (range && !open) end = whole_number(sides[1]);
    if (sides.size() > 2 || !first || !end || *first >= *end) refuse();
    if (open) open_from = std::min(*first, open_from.value_or(*first));
    for (auto plane = *first; !open && plane < *end; ++plane) numbers.push_back(plane);
  }
  return field::Planes::listed(std::move(numbers), open_from);
}

model::Box parse_box(std::string_view text) {
  const auto refuse = [&] {
    throw UsageError({.what = "--region cannot be read",
                      .found = "'" + std::string(text) + "'",
                      .expected = "x0:x1,y0:y1,z0:z1 in m, such as :,0:13.8,0:10"});
  };
  model::Box box;
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
