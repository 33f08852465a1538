#include "elrom/model/target_transform.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "elrom/base/enum_names.hpp"

namespace elrom::model {
namespace {

constexpr base::EnumNames<TransformKind, 3> transforms{
    "target transform",
    {{TransformKind::none, "none"}, {TransformKind::log, "log"}, {TransformKind::asinh, "asinh"}}};

}  // namespace

std::string_view name_of(TransformKind kind) { return transforms.name(kind); }
TransformKind transform_of(std::string_view name) { return transforms.value(name); }

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
