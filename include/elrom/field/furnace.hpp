#pragma once
// A furnace as far as its cases do not tell it: where gas enters and leaves, how its
// mirror images go, how dense its solids are and how they pack, and which of its cases
// are kept for judging. A TOML file beside the mesh says so (data/FORMATS.md, furnace
// description); import reads it, and stores and bundles carry its text.
//
// Thread rule: plain data.

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/symmetry.hpp"

namespace elrom::io {
template <class S>
class SettingsTable;
}

namespace elrom::field {

/// All gas flows [kg/s] among the boundary conditions whose names match `inputs` enter between two heights.
struct Opening {
  std::string inputs;          ///< "secondary_*_lower_*": a name or a shell pattern
  std::string kind = "other";  ///< one of opening_kinds()
  double low_m = 0, high_m = 0;
};
[[nodiscard]] const std::vector<std::string>& opening_kinds();

/// What reports call things. What is not said has a neutral name, so that no problem is taken for another.
struct Words {
  std::optional<std::string> one, many;                      ///< of the cases: "load", "loads"
  std::optional<std::string> truth;                          ///< what computed them: "EL3D"
  [[nodiscard]] std::string case_word(std::size_t n) const;  ///< for n of them
  [[nodiscard]] std::string reference() const;
};

struct Furnace {
  std::string name;
  double solid_density = 0;  ///< [kg/m3]
  double packing_limit = 0;  ///< no time-averaged volume fraction of solids lies above it
  double outlet_low_m = std::numeric_limits<double>::infinity();  ///< above it, gas leaves
  std::vector<std::string> held_out;  ///< cases never trained on, where a study names none: names or patterns
  std::vector<std::string> repeats;   ///< those of them that are run again to tell the noise
  std::vector<Opening> openings;
  std::vector<MirrorDeclaration> mirrors;
  Words words;

  [[nodiscard]] bool is_repeat(std::string_view case_name) const;
  /// The same fields, within what this furnace allows.
  [[nodiscard]] std::vector<FieldInfo> limited(std::vector<FieldInfo> fields) const;
};

/// @throws InputError with file, line, what was found and expected, and the nearest name of a mistaken key
[[nodiscard]] Furnace read_furnace(const std::filesystem::path& file);
/// The same from a text, as stores and bundles carry it. @param where for messages
[[nodiscard]] Furnace parse_furnace(std::string_view text, const std::string& where);
/// Reads back to the same.
[[nodiscard]] std::string to_toml(const Furnace& furnace);

/// @throws InputError when an opening names no boundary condition, or two openings the same gas flow
void expect_fits(const Furnace& furnace, const InputSchema& schema, const std::string& where);
/// Gas flows that no opening names: no balance can count them.
[[nodiscard]] std::vector<std::string> flows_without_opening(const Furnace& furnace,
                                                             const InputSchema& schema);

/// How a mirror is told in TOML, here and in study.toml.
[[nodiscard]] const io::SettingsTable<MirrorDeclaration>& mirror_table();

}  // namespace elrom::field
