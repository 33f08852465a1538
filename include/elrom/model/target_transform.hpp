#pragma once
// A function of a field's values under which a network learns them; undone at prediction.

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

namespace elrom::model {

/// none: z = y. log: z = log(max(y, 0) + scale), for fields >= 0 over several decades. asinh: z = asinh(y /
/// scale), the same for fields of both signs.
enum class TransformKind { none, log, asinh };
[[nodiscard]] std::string_view name_of(TransformKind kind);
/// @throws InputError with the nearest name
[[nodiscard]] TransformKind transform_of(std::string_view name);

struct TargetTransform {
  TransformKind kind = TransformKind::none;
  float scale = 1;  ///< in the field's unit, > 0: below it the transform is close to linear

  /// The transform with its scale taken from training values: the 10 % quantile of the absolute values that
  /// are not zero, which keeps the bulk in the logarithmic part and the traces near zero from stretching it.
  [[nodiscard]] static TargetTransform fit(TransformKind kind, std::span<const float> values);

  [[nodiscard]] float apply(float y) const {
    switch (kind) {
      case TransformKind::log:
        return std::log(std::max(y, 0.0F) + scale);
      case TransformKind::asinh:
        return std::asinh(y / scale);
      case TransformKind::none:
        break;
    }
    return y;
  }
  /// Finite for every finite z: the exponent is kept inside float32.
  [[nodiscard]] float undo(float z) const {
    switch (kind) {
      case TransformKind::log:
        return std::exp(std::min(z, exponent_limit)) - scale;
      case TransformKind::asinh:
        return std::sinh(std::min(std::max(z, -exponent_limit), exponent_limit)) * scale;
      case TransformKind::none:
        break;
    }
    return z;
  }
  bool operator==(const TargetTransform&) const = default;

 private:
  static constexpr float exponent_limit = 60;
};

}  // namespace elrom::model
