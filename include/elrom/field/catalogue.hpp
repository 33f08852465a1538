#pragma once
// The nine fields of a case: their names, units and physical bounds.

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::field {

/// What kind of quantity a field is under a mirror image.
enum class Parity { scalar, vector_x, vector_y, vector_z };

struct FieldInfo {
  std::string name;  ///< "solid_velocity_x"
  std::string meaning;
  std::string unit;  ///< SI: "m/s", "Pa", "m", "1"
  Parity parity = Parity::scalar;
  std::optional<double> lower, upper;  ///< physical bounds, in `unit`; lower of diameter is exclusive
};

/// Packing limit of spheres in the source's EL3D: no time-averaged solid volume fraction lies above it.
inline constexpr double packing_limit = 0.65;

/// The nine fields in the order of the source (velocities
/// of solids, of gas, pressure, diameter, fraction).
[[nodiscard]] std::span<const FieldInfo> standard_fields();
/// Information on a field by name; an unknown name gives a scalar without bounds in `unit`.
[[nodiscard]] FieldInfo field_info(std::string_view name, std::string_view unit = "1");

/// What a message says of a name that is none of `known`: the nearest
/// one. @param where whose names they are, or whose fields
[[nodiscard]] Problem unknown_field(std::span<const FieldInfo> known, std::string_view name,
                                    const std::string& where = {});

/// The fields that a user chose: those of `names`, in their order; all where none is named.
/// @throws Fault for an unknown name, with the nearest
template <class Fault = UsageError>
[[nodiscard]] std::vector<FieldInfo> choose_fields(std::span<const FieldInfo> known,
                                                   std::span<const std::string> names,
                                                   const std::string& where = {}) {
  if (names.empty()) return {known.begin(), known.end()};
  std::vector<FieldInfo> chosen;
  for (const auto& name : names) {
    const auto found = std::ranges::find(known, name, &FieldInfo::name);
    if (found == known.end()) throw Fault(unknown_field(known, name, where));
    chosen.push_back(*found);
  }
  return chosen;
}

/// The same in the order of `known`.
[[nodiscard]] std::vector<FieldInfo> keep_fields(std::span<const FieldInfo> known,
                                                 std::span<const std::string> names,
                                                 const std::string& where = {});

}  // namespace elrom::field
