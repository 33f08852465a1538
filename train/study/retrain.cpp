#include "elrom/study/retrain.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/timing.hpp"
#include "elrom/study/versions.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::ordered_json;

/// A timing file that cannot be used must not stop a retraining.
std::optional<double> recorded_seconds(const std::filesystem::path& folder) {
  try {
    const auto timing = read_timing(folder / "timing.json");
    return timing ? timing->full_seconds : std::nullopt;
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// The same cases in a folder of its own, with nothing to reuse.
double seconds_from_nothing(const std::filesystem::path& study, Settings settings, const Toolbox& toolbox,
                            Log& log, const std::stop_token& stop) {
  const auto folder = study / ".from_nothing";
  std::filesystem::remove_all(folder);
  settings.store = std::filesystem::absolute(study / settings.store).string();
  const base::Stopwatch watch;
  Study(folder, settings, toolbox, log, stop).fit();
  const double seconds = watch.seconds();
  std::filesystem::remove_all(folder);
  return seconds;
}

std::vector<std::string> in_both(const std::vector<std::string>& names,
                                 const std::vector<std::string>& others) {
  std::vector<std::string> both;
  for (const auto& name : names)
    if (std::ranges::find(others, name) != others.end()) both.push_back(name);
  return both;
}

std::vector<std::string> new_cases(const Study& study, const std::vector<std::string>& earlier) {
  std::vector<std::string> added;
  for (const auto& name : study.cases().names)
    if (std::ranges::find(earlier, name) == earlier.end()) added.push_back(name);
  return added;
}

std::vector<std::string> held_out_so_far(const std::filesystem::path& folder) {
  const auto split = folder / "split.json";
  return std::filesystem::exists(split) ? read_split(split).held_out : std::vector<std::string>();
}

/// Judging cases that a model was trained on flatters it; both ways of getting there are told.
void tell_changed_split(const Study& study, const std::vector<std::string>& trained,
                        const std::vector<std::string>& held_out_before, Log& log) {
  std::vector<std::string> held_out;
  for (const auto row : study.held_out()) held_out.push_back(study.store().cases()[row].inputs.name);
  if (const auto seen = in_both(held_out, trained); !seen.empty())
    log.warning("the present model was trained on " + seen.front() + " and " +
                std::to_string(seen.size() - 1) + " more of the held-out cases: they do not judge it");
  if (const auto lost = in_both(held_out_before, study.cases().names); !lost.empty())
    log.warning(
        lost.front() + " and " + std::to_string(lost.size() - 1) +
        " more cases were held out so far and are trained on now; split.held_out in study.toml keeps them out");
}

}  // namespace

RetrainReport retrain(const std::filesystem::path& folder, const Settings& settings, const Toolbox& toolbox,
                      Log& log, const std::stop_token& stop, bool compare) {
  const auto current = folder / "model.elrom";
  if (!std::filesystem::exists(current)) {
    throw InputError({.what = "nothing to retrain",
                      .where = folder.string(),
                      .expected = "model.elrom",
                      .advice = "use elrom-train run first"});
  }
  const auto earlier = model::BundleReader(current).info();
  RetrainReport report{.cases_before = earlier.cases.size(),
                       .seconds_from_nothing = recorded_seconds(folder)};
  const auto held_out_before = held_out_so_far(folder);
  const base::Stopwatch watch;
  {
    Study study(folder, settings, toolbox, log, stop);
    tell_changed_split(study, earlier.cases, held_out_before, log);
    report.cases_after = study.cases().n_cases();
    report.nothing_new = study.is_of_this_study(earlier);
    const Versions versions(folder);
    const auto present = versions.file(versions.current().value_or(0));
    if (report.nothing_new) {
      report.promotion.number = versions.current().value_or(0);
      report.promotion.verdict =
          judge(current, current, study.gate_cases(), settings.gate, settings.n_threads());
    } else if (const auto known = study.version_of_these()) {
      study.judge_again(*known);
      report.promotion = study.promotion();
      report.made_before = true;
    } else {
      study.begin_at(present);
      study.fit();
      report.promotion = study.promotion();
      report.nothing_new = report.promotion.kind == Promotion::Kind::unchanged;
    }
    report.seconds = watch.seconds();
    if (const auto added = new_cases(study, earlier.cases);
        !added.empty() && report.promotion.verdict && !report.nothing_new)
      report.effects = effects_of(added, present, study.gate_cases(), settings.n_threads());
  }
  if (compare) report.seconds_from_nothing = seconds_from_nothing(folder, settings, toolbox, log, stop);
  return report;
}

std::string to_json(const RetrainReport& report) {
  auto json = io::json_head<Json>(io::kinds::retrain);
  const auto& full = report.seconds_from_nothing;
  const auto& verdict = report.promotion.verdict;
  json.update({{"cases_before", report.cases_before},
               {"cases_after", report.cases_after},
               {"seconds", report.seconds},
               {"seconds_from_nothing", full ? Json(*full) : Json()},
               {"error_before", verdict ? Json(verdict->mean.before) : Json()},
               {"error_after", verdict ? Json(verdict->mean.after) : Json()},
               {"judged_on", verdict ? Json(verdict->judged_on) : Json()},
               {"promoted", report.promoted()},
               {"nothing_new", report.nothing_new},
               {"version", report.promotion.number},
               {"verdict", verdict ? Json::parse(to_json(*verdict)) : Json()},
               {"case_effects", report.effects ? Json::parse(to_json(*report.effects)) : Json()}});
  return json.dump(1) + "\n";
}

}  // namespace elrom::study
