// Runs of a scene in words, as a table for the terminal and as JSON.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#include "json_number.hpp"
#include "names.hpp"
#include "scenes_words.hpp"

namespace elrom::report {
namespace {

std::string time_or_part(const std::optional<double>& seconds) {
  return seconds ? run_time_text(*seconds) : "in parts";
}

std::string error_cell(const SceneReport& report, const SceneRunReport& run) {
  if (&run == &report.runs[report.reference]) return report.has_yardstick ? "yardstick" : "reference";
  return run.error ? percent_text(*run.error) : "-";
}

std::string collisions_cell(const SceneRunReport& run) {
  if (!run.files.collisions) return "not counted";
  return fmt::format("{:.0f}", *run.files.collisions);
}

std::vector<const SceneRunReport*> judged_by_error(const SceneReport& report) {
  std::vector<const SceneRunReport*> judged;
  for (const auto& run : report.runs)
    if (run.error) judged.push_back(&run);
  std::ranges::sort(judged, [](const auto* a, const auto* b) { return *a->error < *b->error; });
  return judged;
}

std::string in_time(const SceneRunReport& run) {
  return run.files.seconds ? " in " + run_time_text(*run.files.seconds) : "";
}

std::string count_words(const SceneRunReport& run) {
  if (!run.collision_error) return "";
  const auto share = percent_text(std::abs(*run.collision_error));
  return fmt::format(" and counts {} {} collisions", share, *run.collision_error < 0 ? "fewer" : "more");
}

// Who is at least as near and as fast, and better in one.
const SceneRunReport* winner_over(const SceneReport& report, const SceneRunReport& run) {
  for (const auto& other : report.runs)
    if (&other != &run && other.front && *other.error <= *run.error &&
        *other.files.seconds <= *run.files.seconds)
      return &other;
  return nullptr;
}

// A row of cells across a height: it tells whether solids fall along walls and rise between them.
bool is_across(const SceneSection& section) {
  const auto n = [&](std::size_t a) { return section.centres[a].size(); };
  return n(2) == 1 && std::min(n(0), n(1)) == 1 && std::max(n(0), n(1)) >= 4;
}

/// Velocity of the solids along z in the outermost cells of a row and in its middle, m/s; NaN without solids.
struct EndsAndMiddle {
  double ends, middle;
};

EndsAndMiddle vertical_velocity(const SceneSection& row) {
  const auto of = [&](std::size_t a, std::size_t b) {
    const double fraction = row.fraction[a] + row.fraction[b];
    return fraction > 0 ? (row.flux[2][a] + row.flux[2][b]) / fraction : std::nan("");
  };
  const auto n = row.fraction.size();
  return {of(0, n - 1), of((n - 1) / 2, n / 2)};
}

std::string across_table(const SceneReport& report) {
  std::string text;
  for (const auto& run : report.runs)
    for (const auto& row : run.files.sections) {
      if (!is_across(row)) continue;
      if (text.empty())
        text = "\n  Velocity of the solids along z [m/s]; below zero they fall\n" +
               fmt::format("  {:<28}  {:<24}  {:>8}  {:>8}\n", "run", "section", "ends", "middle");
      const auto [ends, middle] = vertical_velocity(row);
      text += fmt::format("  {:<28}  {:<24}  {:>8.3f}  {:>8.3f}\n", run.name, row.name, ends, middle);
    }
  return text;
}

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

Json json_of(const SceneSection& section) {
  Json node{{"name", section.name},
            {"x_m", section.centres[0]},
            {"y_m", section.centres[1]},
            {"z_m", section.centres[2]},
            {"volume_fraction", numbers(section.fraction)},
            {"flux_x_m_per_s", numbers(section.flux[0])},
            {"flux_y_m_per_s", numbers(section.flux[1])},
            {"flux_z_m_per_s", numbers(section.flux[2])}};
  if (!section.pressure.empty()) node["pressure_pa"] = numbers(section.pressure);
  return node;
}

Json json_of(const SceneRunReport& run) {
  const auto& files = run.files;
  Json node{{"name", run.name},
            {"folder", files.folder.string()},
            {"collision_model", files.model},
            {"time_step_s", files.time_step},
            {"time_s", files.end},
            {"seconds", number(files.seconds)},
            {"threads", files.threads},
            {"spheres", files.spheres},
            {"collisions", number(files.collisions)},
            {"wall_hits", files.wall_hits},
            {"error", number(run.error)},
            {"collision_error", number(run.collision_error)},
            {"front", run.front},
            {"differs", run.differs}};
  node["sections"] = Json::array();
  for (const auto& section : files.sections) node["sections"].push_back(json_of(section));
  return node;
}

}  // namespace

std::string time_text(double seconds) {
  if (seconds < 0.9995e-3) return base::rounded(seconds * 1e6, 3) + " us";
  return seconds < 0.9995 ? base::rounded(seconds * 1e3, 3) + " ms" : base::rounded(seconds, 3) + " s";
}

std::string run_time_text(double seconds) {
  return seconds < 1 ? time_text(seconds) : base::duration(seconds);
}

std::string signed_percent(double share) { return fmt::format("{:+.1f} %", 100 * share); }

std::string reference_text(const SceneReport& report) {
  return report.has_yardstick ? "DEM" : report.runs[report.reference].name;
}

std::string note_text(const SceneReport& report, const SceneRunReport& run) {
  const auto& reference = report.runs[report.reference];
  std::vector<std::string> notes;
  if (&run != &reference && std::abs(run.files.end - reference.files.end) > 0.01 * reference.files.end)
    notes.push_back("ends at " + time_text(run.files.end) + ": not compared");
  if (!run.differs.empty()) notes.push_back("differs in " + base::join(run.differs, ", "));
  if (!run.files.seconds) notes.emplace_back("was stopped and went on: its time is not known");
  if (run.front) notes.emplace_back("on the front");
  return base::join(notes, "; ");
}

std::string error_meaning(const SceneReport& report) {
  if (report.by_profiles)
    return fmt::format(
        "Error: root mean square difference from {} over all cells of all sections, means from {} on, as a share of "
        "its own root mean square; half of it for the volume fraction and half for the flux (fraction times velocity).",
        reference_text(report), time_text(report.from));
  return fmt::format(
      "Error: distance of each group's centre from where {} has it at the end, as a share of how far its spheres "
      "spread. The scene has no sections, which would tell more.",
      reference_text(report));
}

std::string headline(const SceneReport& report) {
  const auto& scene = report.runs.front().files.scene;
  const auto& reference = report.runs[report.reference];
  auto judged = judged_by_error(report);
  // By DEM with other steps only where there is nothing else.
  const auto is_dem = [](const SceneRunReport* run) { return run->files.model == "dem"; };
  if (report.has_yardstick && !std::ranges::all_of(judged, is_dem)) std::erase_if(judged, is_dem);
  if (report.runs.size() == 1)
    return fmt::format("One run of \"{}\", by {}{}: nothing to compare it with.", scene, reference.name,
                       in_time(reference));
  std::string text = report.has_yardstick
                         ? ""
                         : fmt::format(
                               "No run of \"{}\" is by DEM, so nothing here says which is right; "
                               "differences are from {}. ",
                               scene, reference.name);
  if (judged.empty()) return text + fmt::format("No run of \"{}\" can be compared with another.", scene);
  const auto& best = *judged.front();
  text += fmt::format("Nearest to {} on \"{}\" is {}: it is off by {}{}{}", reference_text(report), scene,
                      best.name, percent_text(*best.error), count_words(best), in_time(best));
  if (reference.files.seconds)
    text +=
        fmt::format(", where {} took {}", reference_text(report), run_time_text(*reference.files.seconds));
  text += ".";
  if (judged.size() > 1)
    text +=
        fmt::format(" Farthest is {}, off by {}.", judged.back()->name, percent_text(*judged.back()->error));
  return text;
}

std::string cost_sentence(const SceneReport& report) {
  std::vector<std::string> front, beaten;
  for (const auto* run : judged_by_error(report)) {
    if (run->front)
      front.push_back(fmt::format("{} ({}{})", run->name, percent_text(*run->error), in_time(*run)));
    else if (const auto* winner = run->files.seconds ? winner_over(report, *run) : nullptr)
      beaten.push_back(
          fmt::format("{} ({}{}) by {}", run->name, percent_text(*run->error), in_time(*run), winner->name));
  }
  if (front.empty()) return "No run has both an error and a time.";
  auto text = "On the front, nearest first: " + base::join(front, "; ") + ".";
  if (!beaten.empty()) text += " Beaten in both error and time: " + base::join(beaten, "; ") + ".";
  if (report.runs[report.reference].files.seconds)
    text += fmt::format(" {} itself took {}.", report.has_yardstick ? "DEM" : "The reference",
                        run_time_text(*report.runs[report.reference].files.seconds));
  const auto& runs = report.runs;
  if (std::ranges::any_of(runs, [&](const auto& r) { return r.files.threads != runs[0].files.threads; }))
    text += " The runs had different numbers of threads: their times are not alike.";
  return text;
}

std::string terminal_table(const SceneReport& report) {
  std::size_t width = 6;
  for (const auto& run : report.runs) width = std::max(width, run.name.size());
  auto text =
      fmt::format("\n  {:<{}}  {:>9}  {:>12}  {:>10}  {:>10}  {:>9}\n", "run", width, "error", "collisions",
                  "to " + std::string(report.has_yardstick ? "DEM" : "first"), "wall hits", "run time");
  for (const auto& run : report.runs) {
    const auto note = note_text(report, run);
    text += fmt::format("  {:<{}}  {:>9}  {:>12}  {:>10}  {:>10.0f}  {:>9}{}\n", run.name, width,
                        error_cell(report, run), collisions_cell(run),
                        run.collision_error ? signed_percent(*run.collision_error) : "-", run.files.wall_hits,
                        time_or_part(run.files.seconds), note.empty() ? "" : "  " + note);
  }
  text += across_table(report) + "\n  " + headline(report) + "\n";
  if (report.runs.size() == 1) return text;
  return text + "  " + cost_sentence(report) + "\n  " + error_meaning(report) + "\n";
}

std::string to_json(const SceneReport& report) {
  auto root = io::json_head<Json>(io::kinds::scene_report);
  root["headline"] = headline(report);
  root["cost"] = cost_sentence(report);
  root["error_meaning"] = error_meaning(report);
  root["scene"] = report.runs.front().files.scene;
  root["yardstick"] = report.has_yardstick ? Json(report.runs[report.reference].name) : Json();
  root["reference"] = report.runs[report.reference].name;
  root["means_from_s"] = report.from;
  root["groups"] = report.groups();
  root["runs"] = Json::array();
  for (const auto& run : report.runs) root["runs"].push_back(json_of(run));
  return root.dump(1) + '\n';
}

}  // namespace elrom::report
