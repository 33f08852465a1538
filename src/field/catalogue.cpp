#include "elrom/field/catalogue.hpp"

#include <algorithm>
#include <iterator>

#include "elrom/base/text.hpp"

namespace elrom::field {

std::span<const FieldInfo> standard_fields() {
  static const std::vector<FieldInfo> fields = {
      {"solid_velocity_x",
       "Favre-averaged solid velocity, x (front to rear)",
       "m/s",
       Parity::vector_x,
       {},
       {}},
      {"solid_velocity_y",
       "Favre-averaged solid velocity, y (left to right)",
       "m/s",
       Parity::vector_y,
       {},
       {}},
      {"solid_velocity_z", "Favre-averaged solid velocity, z (upwards)", "m/s", Parity::vector_z, {}, {}},
      {"gas_velocity_x", "Favre-averaged gas velocity, x (front to rear)", "m/s", Parity::vector_x, {}, {}},
      {"gas_velocity_y", "Favre-averaged gas velocity, y (left to right)", "m/s", Parity::vector_y, {}, {}},
      {"gas_velocity_z", "Favre-averaged gas velocity, z (upwards)", "m/s", Parity::vector_z, {}, {}},
      {"pressure", "time-averaged pressure, gauge, at the outlet", "Pa", Parity::scalar, {}, {}},
      {"solid_diameter", "diameter of solids, averaged over the cell and time", "m", Parity::scalar, 0.0, {}},
      {"solid_volume_fraction", "time-averaged volume fraction of solids", "1", Parity::scalar, 0.0,
       packing_limit},
  };
  return fields;
}

FieldInfo field_info(std::string_view name, std::string_view unit) {
  const auto known = standard_fields();
  const auto found =
      std::find_if(known.begin(), known.end(), [&](const FieldInfo& f) { return f.name == name; });
  if (found != known.end()) return *found;
  return {.name = std::string(name), .meaning = std::string(name), .unit = std::string(unit)};
}

Problem unknown_field(std::span<const FieldInfo> known, std::string_view name, const std::string& where) {
  std::vector<std::string> names;
  for (const auto& info : known) names.push_back(info.name);
  return {.what = "unknown field '" + std::string(name) + "'",
          .where = where,
          .advice = base::name_advice(name, names)};
}

std::vector<FieldInfo> keep_fields(std::span<const FieldInfo> known, std::span<const std::string> names,
                                   const std::string& where) {
  const auto chosen = choose_fields(known, names, where);
  std::vector<FieldInfo> kept;
  std::ranges::copy_if(known, std::back_inserter(kept), [&](const FieldInfo& info) {
    return std::ranges::find(chosen, info.name, &FieldInfo::name) != chosen.end();
  });
  return kept;
}

}  // namespace elrom::field
