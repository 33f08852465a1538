#pragma once
// A scene as its TOML file tells it (data/FORMATS.md, scene). Everything has a default but the time step, the
// duration and the particles. Numbers are in SI, texts carry a unit: "315 um".
//
// Thread rule: plain data.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/scene/inlet.hpp"

namespace elrom::io {
template <class S>
class SettingsTable;
class SettingValue;
}  // namespace elrom::io

namespace elrom::scene {

struct BoxSettings {
  std::string name;
  Vec low, high;                          ///< m
  std::vector<double> top_low, top_high;  ///< x, y of the top where it differs, m
  std::string turn_axis = "z";
  double turn_angle = 0;  ///< rad
  Vec turn_about;         ///< m

  [[nodiscard]] Body body() const;
};

struct GroupSettings {
  std::string group;
  std::string distribution = "value";
  double diameter = 0, deviation = 0;       ///< m
  std::optional<double> smallest, largest;  ///< m
  double density = 1000;                    ///< kg/m3
  std::optional<std::int64_t> number;
  std::optional<double> mass;  ///< kg, instead of the number
  double parcels = 1;          ///< spheres that each stands for
  std::string region;          ///< empty: the first box
  std::string arrangement = "random";
  Vec velocity;        ///< m/s
  double scatter = 0;  ///< m/s
  double over = 0;     ///< s
};

/// Sums over the cells of a box, at every output.
struct SectionSettings {
  std::string name;
  Vec low, high;                       ///< m
  std::vector<double> cells{1, 1, 1};  ///< in x, y, z
};

/// Gas that comes in through a side.
struct GasInletSettings {
  std::string side;  ///< "box.z_low"
  Vec velocity;      ///< m/s, superficial
};

struct SceneSettings {
  std::string name = "scene";
  double duration = 0, time_step = 0;  ///< s
  std::uint64_t seed = 1;

  std::vector<BoxSettings> boxes, regions;
  std::vector<std::string> outlets, openings, periodic;

  std::string gas = "none";  ///< none, uniform, frozen, coupled
  particle::Gas gas_properties;
  Vec gas_velocity;  ///< m/s
  std::string gas_file;
  std::vector<GasInletSettings> gas_inlets;
  Vec cell;  ///< of the grid, m
  particle::GranularLaw granular;
  std::string radial = "lun", viscosity = "gidaspow";

  std::vector<GroupSettings> groups;

  Vec gravity;  ///< m/s2
  bool buoyancy = false, rotation = false;
  std::string drag = "none", walls = "reflect", collisions = "none";
  std::string recirculation;   ///< region; empty: none
  Vec recirculation_velocity;  ///< m/s

  WallLaw wall_law;
  std::string collision_model = "exact";  ///< or a file of elrom-train collisions
  std::string law = "linear";
  particle::ContactLaw contact;
  std::optional<double> stiffness;     ///< N/m
  std::optional<double> contact_time;  ///< s, helscm
  int steps_per_contact = 20;          ///< dem

  std::vector<SectionSettings> sections;
  double output_every = 0, checkpoint_every = 0;  ///< s; 0: at the end
  std::vector<std::string> formats{"vtp"};

  std::filesystem::path folder;  ///< that files are named from: the scene's own

  [[nodiscard]] Domain domain() const;  ///< @throws UsageError
  [[nodiscard]] std::int64_t n_steps() const;
  [[nodiscard]] bool has_parcels() const;
  /// Whether an effect needs the grid.
  [[nodiscard]] bool needs_grid() const;
  /// How many steps between outputs or checkpoints: at least 1. @param every s; 0: all
  [[nodiscard]] std::int64_t steps_in(double every) const;
};

/// @param overrides "effects.collisions=dem", as on a command line
/// @throws UsageError with file, line, what was found and expected, and the nearest name of a mistaken key
[[nodiscard]] SceneSettings read_scene(const std::filesystem::path& file,
                                       const std::vector<std::string>& overrides = {});
[[nodiscard]] SceneSettings parse_scene(std::string_view text, const std::string& where,
                                        const std::vector<std::string>& overrides = {});
/// Reads back to the same.
[[nodiscard]] std::string to_toml(const SceneSettings& scene);
/// Keys and what they mean, for --help.
[[nodiscard]] std::string scene_help();

}  // namespace elrom::scene
