// What elrom-simulate left in a folder, read again (data/FORMATS.md, scene output).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/report/scenes.hpp"
#include "json_number.hpp"

namespace elrom::report {
namespace {

namespace fs = std::filesystem;
constexpr const char* again = "simulate again with elrom-simulate, to the end of the scene";

Columns read_columns(const fs::path& path) {
  const auto table = io::read_csv(path);
  Columns columns{table.headings, std::vector<std::vector<double>>(table.headings.size())};
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    for (std::size_t column = 0; column < columns.values.size(); ++column) {
      const auto value = base::to_double(table.rows[row][column]);
      if (!value)
        throw InputError(Problem{.what = "not a number",
                                 .where = table.place(row, column),
                                 .found = "'" + table.rows[row][column] + "'"});
      columns.values[column].push_back(*value);
    }
  return columns;
}

const std::vector<double>& column(const Columns& columns, const std::string& heading, const fs::path& path) {
  const auto* found = columns.find(heading);
  if (found == nullptr)
    throw InputError(
        Problem{.what = "missing column '" + heading + "'", .where = path.string(), .advice = again});
  return *found;
}

// Distinct values of a coordinate, ascending.
std::vector<double> centres_along(const std::vector<double>& values, std::size_t n) {
  std::vector<double> centres(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n));
  std::ranges::sort(centres);
  centres.erase(std::unique(centres.begin(), centres.end()), centres.end());
  return centres;
}

SceneSection read_section(const fs::path& path, double from) {
  const auto columns = read_columns(path);
  const auto& time = column(columns, "time [s]", path);
  SceneSection section;
  section.name = path.stem().string().substr(std::strlen("section_"));
  const auto n_cells = static_cast<std::size_t>(
      std::ranges::find_if(time, [&](double t) { return t != time[0]; }) - time.begin());
  std::size_t product = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::string heading = std::string(1, "xyz"[a]) + " [m]";
    section.centres[a] = centres_along(column(columns, heading, path), n_cells);
    product *= section.centres[a].size();
  }
  if (n_cells == 0 || product != n_cells || time.size() % n_cells != 0)
    throw InputError(
        Problem{.what = "cells of a section are missing", .where = path.string(), .advice = again});
  const auto& fraction = column(columns, "volume_fraction", path);
  section.fraction.assign(n_cells, 0);
  double n_outputs = 0;
  for (std::size_t row = 0; row < time.size(); ++row) {
    if (time[row] < from * (1 - 1e-9)) continue;
    if (row % n_cells == 0) ++n_outputs;
    section.fraction[row % n_cells] += fraction[row];
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const auto& velocity = column(columns, "velocity_" + std::string(1, "xyz"[a]) + " [m/s]", path);
    section.flux[a].assign(n_cells, 0);
    for (std::size_t row = 0; row < time.size(); ++row)
      if (time[row] >= from * (1 - 1e-9)) section.flux[a][row % n_cells] += fraction[row] * velocity[row];
  }
  if (const auto* pressure = columns.find("gas_pressure [Pa]")) {
    section.pressure.assign(n_cells, 0);
    for (std::size_t row = 0; row < time.size(); ++row)
      if (time[row] >= from * (1 - 1e-9)) section.pressure[row % n_cells] += (*pressure)[row];
  }
  for (auto* sums :
       {&section.fraction, &section.flux[0], &section.flux[1], &section.flux[2], &section.pressure})
    for (double& sum : *sums) sum /= std::max(1.0, n_outputs);
  return section;
}

// The part of a text between two others; nothing where either is missing.
std::optional<std::string> between(const std::string& text, std::string_view before, std::string_view after,
                                   std::size_t start = 0) {
  const auto at = text.find(before, start);
  if (at == std::string::npos) return {};
  const auto end = text.find(after, at + before.size());
  if (end == std::string::npos) return {};
  return text.substr(at + before.size(), end - at - before.size());
}

/// Arrays of a .vtp that elrom-simulate wrote: appended, raw, each behind its number of bytes.
class PointFile {
 public:
  explicit PointFile(const fs::path& path) : where_(path.string()), text_(base::read_text(path)) {
    const auto at = text_.find("<AppendedData encoding=\"raw\">");
    data_ = at == std::string::npos ? at : text_.find('_', at);
    if (data_ == std::string::npos) refuse("appended data");
  }
  [[nodiscard]] std::size_t n_points() const {
    const auto n = between(text_, "NumberOfPoints=\"", "\"");
    const auto value = n ? base::to_double(*n) : std::nullopt;
    if (!value || !(*value >= 0 && *value < 1e9)) refuse("a number of points");
    return static_cast<std::size_t>(*value);
  }
  template <class T>
  [[nodiscard]] std::vector<T> array(const std::string& name, std::size_t n) const {
    const auto at = text_.find("Name=\"" + name + "\"");
    const auto offset = at < data_ ? between(text_, "offset=\"", "\"", at) : std::nullopt;
    const auto value = offset ? base::to_double(*offset) : std::nullopt;
    const std::size_t begin = value && *value >= 0 && *value < 1e12
                                  ? data_ + 1 + sizeof(std::uint64_t) + static_cast<std::size_t>(*value)
                                  : text_.size() + 1;
    if (begin + n * sizeof(T) > text_.size()) refuse("array '" + name + "'");
    std::vector<T> values(n);
    if (n > 0) std::memcpy(values.data(), text_.data() + begin, n * sizeof(T));
    return values;
  }

 private:
  [[noreturn]] void refuse(const std::string& expected) const {
    throw InputError(Problem{
        .what = "a damaged picture of spheres", .where = where_, .expected = expected, .advice = again});
  }
  std::string where_, text_;
  std::size_t data_ = 0;
};

std::optional<ScenePoints> read_points(const fs::path& folder, std::size_t n_groups) {
  const auto movie = folder / "particles.pvd";
  if (!fs::exists(movie)) return {};
  const auto text = io::read_small_text(movie);
  const auto name = between(text, "file=\"", "\"", text.rfind("<DataSet"));
  if (!name) throw InputError(Problem{.what = "a movie without pictures", .where = movie.string()});
  const PointFile file(folder / fs::path(*name).filename());
  const auto n = file.n_points();
  ScenePoints points{.group = file.array<std::int32_t>("group", n)};
  for (const auto group : points.group)
    if (group < 0 || static_cast<std::size_t>(group) >= n_groups)
      throw InputError(Problem{.what = "a sphere of no group", .where = (folder / *name).string()});
  const auto places = file.array<float>("Points", 3 * n);
  for (std::size_t i = 0; i < places.size(); ++i) points.place[i % 3].push_back(places[i]);
  return points;
}

std::vector<SceneSection> read_sections(const fs::path& folder, double from) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (base::matches(entry.path().filename().string(), "section_*.csv")) paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<SceneSection> sections;
  for (const auto& path : paths) sections.push_back(read_section(path, from));
  return sections;
}

// "gas.model" -> "\"coupled\"" of the resolved settings; of lists of tables all together: "particles".
std::map<std::string, std::string> read_settings(const fs::path& path) {
  std::map<std::string, std::string> settings;
  std::string table;
  bool is_list = false;
  for (const auto& line : base::split(io::read_small_text(path), '\n')) {
    if (line.starts_with("[")) {
      is_list = line.starts_with("[[");
      table = base::trim(line);
      std::erase_if(table, [](char c) { return c == '[' || c == ']'; });
    } else if (const auto at = line.find(" = "); at != std::string::npos) {
      if (is_list)
        settings[table] += line + "\n";
      else
        settings[table + "." + line.substr(0, at)] = line.substr(at + 3);
    }
  }
  return settings;
}

std::vector<std::string> groups_of(const Columns& series) {
  constexpr std::string_view before = "number of ";
  std::vector<std::string> groups;
  for (const auto& heading : series.headings)
    if (heading.starts_with(before)) groups.push_back(heading.substr(before.size()));
  return groups;
}

Json read_summary(const fs::path& path) {
  if (!fs::exists(path))
    throw InputError(
        Problem{.what = "no finished run of elrom-simulate", .where = path.string(), .advice = again});
  const auto json = Json::parse(io::read_small_text(path), nullptr, false);
  io::check_json_kind(json, io::kinds::scene_summary, path.string());
  return json;
}

void fill_from_summary(SceneRunFiles& run, const fs::path& path) {
  const auto json = read_summary(path);
  try {
    run.scene = json.at("scene").get<std::string>();
    run.model = json.at("collision_model").get<std::string>();
    run.time_step = json.at("time_step_s").get<double>();
    run.end = json.at("time_s").get<double>();
    run.threads = json.at("threads").get<int>();
    run.spheres = json.at("spheres").get<std::size_t>();
    run.wall_hits = json.at("wall_hits").get<double>();
    if (json.at("resumed_from").get<double>() == 0) {
      run.seconds = 0;
      for (const auto& effect : json.at("effects")) *run.seconds += effect.at("seconds").get<double>();
    }
    if (run.model != "none" && run.model != "hel") run.collisions = json.at("collisions").get<double>();
  } catch (const Json::exception& error) {
    throw InputError(
        Problem{.what = "a damaged summary", .where = path.string(), .found = error.what(), .advice = again});
  }
}

}  // namespace

const std::vector<double>* Columns::find(const std::string& heading) const {
  const auto found = std::ranges::find(headings, heading);
  return found == headings.end() ? nullptr : &values[static_cast<std::size_t>(found - headings.begin())];
}

SceneRunFiles read_scene_run(const fs::path& folder, std::optional<double> from) {
  SceneRunFiles run;
  run.folder = folder;
  fill_from_summary(run, folder / "summary.json");
  run.series = read_columns(folder / "series.csv");
  for (const auto* heading : {"time [s]", "spheres", "kinetic_energy [J]", "collisions"})
    static_cast<void>(column(run.series, heading, folder / "series.csv"));
  run.groups = groups_of(run.series);
  run.sections = read_sections(folder, from.value_or(0.5 * run.end));
  run.points = read_points(folder, run.groups.size());
  run.settings = read_settings(folder / "scene.toml");
  return run;
}

}  // namespace elrom::report
