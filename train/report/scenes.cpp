#include "elrom/report/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elrom/base/error.hpp"
#include "scenes_words.hpp"

namespace elrom::report {
namespace {

// DEM by the shortest step; else the first.
void choose_reference(SceneReport& report) {
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const auto& run = report.runs[i].files;
    if (run.model != "dem") continue;
    if (report.has_yardstick && run.time_step >= report.runs[report.reference].files.time_step) continue;
    report.reference = i;
    report.has_yardstick = true;
  }
}

void name_runs(std::vector<SceneRunReport>& runs) {
  const auto usual = [](const SceneRunReport& run) {
    return run.files.model + ", " + time_text(run.files.time_step);
  };
  for (auto& run : runs) {
    run.name = usual(run);
    const auto alike =
        std::ranges::count_if(runs, [&](const auto& other) { return usual(other) == usual(run); });
    if (alike > 1) run.name += " (" + run.files.folder.filename().string() + ")";
  }
}

// What may differ between runs that are compared: the model, the step and what is written.
bool may_differ(const std::string& key) {
  return key == "effects.collisions" || key == "effects.walls" || key == "scene.time_step" ||
         key.starts_with("output.");
}

std::vector<std::string> differences(const SceneRunFiles& run, const SceneRunFiles& reference) {
  std::set<std::string> keys;
  for (const auto* settings : {&run.settings, &reference.settings})
    for (const auto& [key, value] : *settings) keys.insert(key);
  const auto value = [](const SceneRunFiles& of, const std::string& key) {
    const auto found = of.settings.find(key);
    return found == of.settings.end() ? std::string() : found->second;
  };
  std::vector<std::string> differ;
  for (const auto& key : keys)
    if (!may_differ(key) && value(run, key) != value(reference, key)) differ.push_back(key);
  return differ;
}

struct Distance {
  double difference = 0, size = 0;  // sums of squares
  void add(const std::vector<double>& values, const std::vector<double>& truth) {
    for (std::size_t i = 0; i < truth.size(); ++i) {
      difference += (values[i] - truth[i]) * (values[i] - truth[i]);
      size += truth[i] * truth[i];
    }
  }
  [[nodiscard]] std::optional<double> share() const {
    return size > 0 ? std::optional(std::sqrt(difference / size)) : std::nullopt;
  }
};

std::optional<double> profile_error(const SceneRunFiles& run, const SceneRunFiles& reference) {
  Distance fraction, flux;
  for (const auto& truth : reference.sections) {
    const auto found = std::ranges::find_if(run.sections, [&](const SceneSection& section) {
      return section.name == truth.name && section.centres == truth.centres;
    });
    if (found == run.sections.end()) return {};
    fraction.add(found->fraction, truth.fraction);
    for (std::size_t a = 0; a < 3; ++a) flux.add(found->flux[a], truth.flux[a]);
  }
  const auto of_fraction = fraction.share(), of_flux = flux.share();
  return of_fraction && of_flux ? std::optional(0.5 * (*of_fraction + *of_flux)) : std::nullopt;
}

/// Of each group: centre of its spheres, and their mean square distance from it.
struct Cloud {
  double n = 0, spread = 0;
  std::array<double, 3> centre{};
};

std::vector<Cloud> clouds_of(const ScenePoints& points, std::size_t n_groups) {
  std::vector<Cloud> clouds(n_groups);
  const auto group = [&](std::size_t i) -> Cloud& {
    return clouds[static_cast<std::size_t>(points.group[i])];
  };
  for (std::size_t i = 0; i < points.group.size(); ++i) {
    ++group(i).n;
    for (std::size_t a = 0; a < 3; ++a) group(i).centre[a] += points.place[a][i];
  }
  for (auto& cloud : clouds)
    for (auto& component : cloud.centre) component /= std::max(1.0, cloud.n);
  for (std::size_t i = 0; i < points.group.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      group(i).spread += std::pow(points.place[a][i] - group(i).centre[a], 2) / group(i).n;
  return clouds;
}

std::optional<double> centre_error(const SceneRunFiles& run, const SceneRunFiles& reference) {
  if (!run.points || !reference.points) return {};
  const auto clouds = clouds_of(*run.points, run.groups.size()),
             truth = clouds_of(*reference.points, run.groups.size());
  Distance distance;
  for (std::size_t g = 0; g < truth.size(); ++g) {
    if (clouds[g].n == 0 || truth[g].n == 0) continue;
    for (std::size_t a = 0; a < 3; ++a)
      distance.difference += std::pow(clouds[g].centre[a] - truth[g].centre[a], 2);
    distance.size += truth[g].spread;
  }
  return distance.share();
}

void judge(SceneReport& report) {
  const auto& reference = report.runs[report.reference].files;
  report.by_profiles = !reference.sections.empty();
  for (auto& run : report.runs) {
    if (&run.files == &reference) continue;
    run.differs = differences(run.files, reference);
    // Means over other times are no error of a model.
    if (std::abs(run.files.end - reference.end) > 0.01 * reference.end) continue;
    run.error = report.by_profiles ? profile_error(run.files, reference) : centre_error(run.files, reference);
    if (run.files.collisions && reference.collisions && *reference.collisions > 0)
      run.collision_error = *run.files.collisions / *reference.collisions - 1;
  }
}

bool has_both(const SceneRunReport& run) { return run.error && run.files.seconds; }

bool beats(const SceneRunReport& a, const SceneRunReport& b) {
  return has_both(a) && *a.error <= *b.error && *a.files.seconds <= *b.files.seconds &&
         (*a.error < *b.error || *a.files.seconds < *b.files.seconds);
}

void mark_front(std::vector<SceneRunReport>& runs) {
  for (auto& run : runs)
    run.front =
        has_both(run) && std::ranges::none_of(runs, [&](const auto& other) { return beats(other, run); });
}

void expect_one_scene(const std::vector<SceneRunReport>& runs) {
  const auto& first = runs.front().files;
  for (const auto& run : runs)
    if (run.files.scene != first.scene || run.files.groups != first.groups)
      throw InputError(Problem{.what = "runs of different scenes or groups",
                               .where = run.files.folder.string(),
                               .found = "'" + run.files.scene + "'",
                               .expected = "'" + first.scene + "', as in " + first.folder.string()});
}

}  // namespace

SceneReport scene_report(const SceneReportOptions& options) {
  if (options.folders.empty())
    throw UsageError("no run to report on; name a folder that elrom-simulate wrote");
  SceneReport report;
  auto from = options.from;
  for (const auto& folder : options.folders) {
    report.runs.push_back({.files = read_scene_run(folder, from)});
    if (!from) from = 0.5 * report.runs.front().files.end;
  }
  report.from = *from;
  expect_one_scene(report.runs);
  name_runs(report.runs);
  choose_reference(report);
  judge(report);
  mark_front(report.runs);
  return report;
}

}  // namespace elrom::report
