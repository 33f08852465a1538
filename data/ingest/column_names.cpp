#include "column_names.hpp"

#include <algorithm>
#include <cctype>

#include "elrom/field/catalogue.hpp"

namespace elrom::ingest {
namespace {

struct Spellings {
  std::string_view field;
  std::vector<std::string_view> headings;
};

// Fluent writes the mixture's or primary phase's quantities without a prefix and those of other phases as
// "<phase>-<quantity>"; the phase names here are the usual ones of gas-solids set-ups.
const std::vector<Spellings>& table() {
  static const std::vector<Spellings> spellings = {
      {"solid_velocity_x",
       {"solids-x-velocity", "solid-x-velocity", "particle-x-velocity", "phase-2-x-velocity"}},
      {"solid_velocity_y",
       {"solids-y-velocity", "solid-y-velocity", "particle-y-velocity", "phase-2-y-velocity"}},
      {"solid_velocity_z",
       {"solids-z-velocity", "solid-z-velocity", "particle-z-velocity", "phase-2-z-velocity"}},
      {"gas_velocity_x", {"x-velocity", "gas-x-velocity", "air-x-velocity", "phase-1-x-velocity"}},
      {"gas_velocity_y", {"y-velocity", "gas-y-velocity", "air-y-velocity", "phase-1-y-velocity"}},
      {"gas_velocity_z", {"z-velocity", "gas-z-velocity", "air-z-velocity", "phase-1-z-velocity"}},
      {"pressure", {"static-pressure", "gauge-pressure", "mixture-pressure"}},
      {"solid_diameter", {"solids-diameter", "particle-diameter", "phase-2-diameter", "dpm-diameter"}},
      {"solid_volume_fraction",
       {"solids-vof", "solid-vof", "particle-vof", "phase-2-vof", "solids-volume-fraction",
        "particle-volume-fraction"}},
  };
  return spellings;
}

std::string plain(std::string_view heading) {
  std::string text;
  for (const char c : heading) {
    if (c == '-' || c == '_' || c == ' ') continue;
    text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> names) {
  return std::any_of(names.begin(), names.end(), [&](std::string_view n) { return plain(n) == name; });
}

}  // namespace

ColumnMeaning column_meaning(std::string_view heading) {
  const auto name = plain(heading);
  if (is_one_of(name, {"x-coordinate", "x"})) return {ColumnKind::x, {}, "m"};
  if (is_one_of(name, {"y-coordinate", "y"})) return {ColumnKind::y, {}, "m"};
  if (is_one_of(name, {"z-coordinate", "z"})) return {ColumnKind::z, {}, "m"};
  if (is_one_of(name, {"cell-volume", "volume"})) return {ColumnKind::volume, {}, "m3"};
  for (const auto& info : field::standard_fields()) {
    const auto headings = known_headings(info.name);
    if (std::any_of(headings.begin(), headings.end(),
                    [&](const std::string& h) { return plain(h) == name; })) {
      return {ColumnKind::field, info.name, info.unit};
    }
  }
  return {};
}

std::vector<std::string> known_headings(std::string_view field) {
  std::vector<std::string> headings{std::string(field)};
  for (const auto& entry : table()) {
    if (entry.field == field) headings.insert(headings.end(), entry.headings.begin(), entry.headings.end());
  }
  return headings;
}

}  // namespace elrom::ingest
