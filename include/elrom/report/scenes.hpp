#pragma once
// Runs of one scene beside each other, as elrom-simulate left them: several collision models and time steps,
// soft spheres (DEM) as the yardstick. Read from files; nothing is simulated.

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace elrom::report {

struct SceneReportOptions {
  std::vector<std::filesystem::path> folders;  ///< that elrom-simulate wrote
  std::optional<double> from;  ///< means are over the outputs from here on, s; none: half of the first run
};

/// A table of numbers.
struct Columns {
  std::vector<std::string> headings;
  std::vector<std::vector<double>> values;                                          ///< (n_columns, n_rows)
  [[nodiscard]] const std::vector<double>* find(const std::string& heading) const;  ///< null: no such
};

/// Means in time over the cells of a section, x running fastest.
struct SceneSection {
  std::string name;
  std::array<std::vector<double>, 3> centres;  ///< of the cells along x, y, z, ascending, m
  std::vector<double> fraction;                ///< of the volume, (cells)
  std::array<std::vector<double>, 3> flux;     ///< fraction times velocity, m/s
  std::vector<double> pressure;                ///< of a coupled gas, Pa; else empty
};

/// Where spheres or parcels are at the end.
struct ScenePoints {
  std::array<std::vector<float>, 3> place = {};  ///< m
  std::vector<std::int32_t> group;               ///< index in SceneReport::groups
};

struct SceneRunFiles {
  std::filesystem::path folder;
  std::string scene, model;
  double time_step = 0, end = 0;  ///< s
  /// Of all effects, without the writing of outputs; none where the run was stopped and went on.
  std::optional<double> seconds;
  int threads = 1;
  std::size_t spheres = 0;           ///< or parcels, at the end
  std::optional<double> collisions;  ///< none where the model counts none
  double wall_hits = 0;
  std::vector<std::string> groups;
  Columns series;
  std::vector<SceneSection> sections;
  std::optional<ScenePoints> points;
  std::map<std::string, std::string> settings;  ///< "gas.model": as its resolved scene has it
};

struct SceneRunReport {
  SceneRunFiles files;
  std::string name = {};  ///< "helscm, 0.1 ms"
  /// Other settings than the reference's, but for model, step and output: "gas.model", "particles".
  std::vector<std::string> differs = {};
  std::optional<double> error = {};            ///< from the reference, as a share of it: see error_meaning()
  std::optional<double> collision_error = {};  ///< signed share of the reference's count
  bool front = false;  ///< no other is at least as near and as fast, and better in one
};

struct SceneReport {
  double from = 0;  ///< s, of the means
  std::vector<SceneRunReport> runs;
  std::size_t reference = 0;   ///< of `runs`: DEM by the shortest step; else the first
  bool has_yardstick = false;  ///< the reference is DEM
  bool by_profiles = false;    ///< errors are of the sections; else of the groups' centres

  [[nodiscard]] const std::vector<std::string>& groups() const { return runs[reference].files.groups; }
};

/// Reads DIR/summary.json, series.csv, section_*.csv, scene.toml and the last picture of particles.pvd.
/// @throws InputError naming the file that is missing, damaged or of another scene
[[nodiscard]] SceneRunFiles read_scene_run(const std::filesystem::path& folder, std::optional<double> from);
/// @throws InputError; UsageError without a folder
[[nodiscard]] SceneReport scene_report(const SceneReportOptions& options);

/// Which run is nearest to DEM, in words; or that there is no yardstick.
[[nodiscard]] std::string headline(const SceneReport& report);
/// The runs on the front of error and run time, and those that another beats in both.
[[nodiscard]] std::string cost_sentence(const SceneReport& report);
/// What the errors are errors of.
[[nodiscard]] std::string error_meaning(const SceneReport& report);

[[nodiscard]] std::string terminal_table(const SceneReport& report);
[[nodiscard]] std::string to_json(const SceneReport& report);
/// One HTML file that opens offline.
[[nodiscard]] std::string html_page(const SceneReport& report);

}  // namespace elrom::report
