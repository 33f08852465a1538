#include "elrom/model/target_transform.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::model {
namespace {

constexpr std::array<std::pair<std::string_view, TransformKind>, 3> kinds{
    {{"none", TransformKind::none}, {"log", TransformKind::log}, {"asinh", TransformKind::asinh}}};

}  // namespace

std::string_view name_of(TransformKind kind) {
  for (const auto& [name, value] : kinds)
    if (value == kind) return name;
  throw std::logic_error("target transform without a name");
}

TransformKind transform_of(std::string_view name) {
  std::vector<std::string> known;
  for (const auto& [known_name, value] : kinds) {
    if (known_name == name) return value;
    known.emplace_back(known_name);
  }
  throw InputError({"unknown target transform", {}, std::string(name), {}, base::name_advice(name, known)});
}

TargetTransform TargetTransform::fit(TransformKind kind, std::span<const float> values) {
  if (kind == TransformKind::none) return {};
  std::vector<float> sizes;
  for (const float value : values)
    if (std::isfinite(value) && value != 0) sizes.push_back(std::abs(value));
  if (sizes.empty()) return {kind, 1.0F};
  const auto tenth = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 10);
  std::nth_element(sizes.begin(), tenth, sizes.end());
  return {kind, std::max(*tenth, 1e-30F)};
}

}  // namespace elrom::model
