#include "elrom/field/planes.hpp"

#include <algorithm>
#include <string>

#include "elrom/base/error.hpp"

namespace elrom::field {
namespace {

[[noreturn]] void refuse(std::int32_t plane, const std::string& expected) {
  throw UsageError({.what = "plane " + std::to_string(plane) + " cannot be asked for", .expected = expected});
}

}  // namespace

Planes::Planes(std::vector<std::int32_t> numbers) : numbers_(std::move(numbers)), open_from_() {
  if (numbers_.empty()) throw UsageError("no plane is asked for");
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    if (numbers_[i] < 0 || (i > 0 && numbers_[i] <= numbers_[i - 1]))
      refuse(numbers_[i], "planes from 0 on, ascending");
  }
}

Planes Planes::listed(std::vector<std::int32_t> numbers, std::optional<std::int32_t> open_from) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  if (!open_from) return Planes(std::move(numbers));
  std::erase_if(numbers, [&](std::int32_t plane) { return plane >= *open_from; });
  Planes planes;
  if (!numbers.empty()) planes = Planes(std::move(numbers));
  planes.open_from_ = open_from;
  return planes;
}

bool Planes::fit(std::size_t n_planes) const { return static_cast<std::size_t>(highest()) < n_planes; }

std::vector<std::int32_t> Planes::numbers(std::size_t n_planes) const {
  if (!fit(n_planes))
    refuse(highest(), n_planes == 0 ? "planes" : "planes from 0 to " + std::to_string(n_planes - 1));
  auto numbers = numbers_;
  if (!open_from_) return numbers;
  for (auto plane = static_cast<std::size_t>(*open_from_); plane < n_planes; ++plane)
    numbers.push_back(static_cast<std::int32_t>(plane));
  return numbers;
}

}  // namespace elrom::field
