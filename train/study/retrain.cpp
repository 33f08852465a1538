#include "elrom/study/retrain.hpp"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/timing.hpp"

namespace elrom::study {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// From the cross-validation that a bundle was chosen by.
double cross_validated_error(const std::filesystem::path& bundle) {
  const auto accuracy = Json::parse(model::BundleReader(bundle).info().accuracy_json);
  double sum = 0;
  for (const auto& [field, entry] : accuracy.items()) sum += entry.value("nrmse", 1.0);
  return sum / static_cast<double>(std::max<std::size_t>(accuracy.size(), 1));
}

double error_of(const std::filesystem::path& bundle, const Study& study) {
  return study.held_out().empty() ? cross_validated_error(bundle)
                                  : held_out_error(bundle, study.store(), study.held_out());
}

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
  const auto begin = Clock::now();
  Study(folder, settings, toolbox, log, stop).fit();
  const double seconds = since(begin);
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
                std::to_string(seen.size() - 1) +
                " more of the held-out cases: its error there is too small");
  if (const auto lost = in_both(held_out_before, study.cases().names); !lost.empty())
    log.warning(
        lost.front() + " and " + std::to_string(lost.size() - 1) +
        " more cases were held out so far and are trained on now; split.held_out in study.toml keeps them out");
}

}  // namespace

double held_out_error(const std::filesystem::path& bundle, const field::SnapshotStore& store,
                      const std::vector<std::size_t>& rows) {
  const model::Predictor predictor(bundle);
  std::vector<std::size_t> others;
  for (const auto row : store.find("*"))
    if (std::ranges::find(rows, row) == rows.end()) others.push_back(row);
  const MatrixD inputs = store.inputs(rows);
  const std::size_t n_cells = store.mesh().n_cells(), n_fields = predictor.fields().size();
  std::vector<MatrixF> truth, mean;
  for (const auto& info : predictor.fields()) {
    truth.push_back(store.read(info.name, rows));
    mean.emplace_back(store.read(info.name, others).colwise().mean());
  }
  std::vector<float> values(predictor.size());
  model::Predictor::Scratch scratch;
  std::vector<double> error(n_fields), departure(n_fields);
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    predictor.predict({inputs.row(i).data(), static_cast<std::size_t>(inputs.cols())}, values, {}, scratch);
    for (std::size_t f = 0; f < n_fields; ++f) {
      const std::span<const float> y(truth[f].row(i).data(), n_cells);
      error[f] += math::squared_distance(std::span(values).subspan(f * n_cells, n_cells), y);
      departure[f] += math::squared_distance({mean[f].data(), n_cells}, y);
    }
  }
  double sum = 0;
  for (std::size_t f = 0; f < n_fields; ++f) sum += math::nrmse(error[f], departure[f], 0);
  return sum / static_cast<double>(n_fields);
}

RetrainReport retrain(const std::filesystem::path& folder, const Settings& settings, const Toolbox& toolbox,
                      Log& log, const std::stop_token& stop, bool compare) {
  const auto current = folder / "model.elrom", candidate = folder / "candidate.elrom";
  if (!std::filesystem::exists(current)) {
    throw InputError({.what = "nothing to retrain",
                      .where = folder.string(),
                      .expected = "model.elrom",
                      .advice = "use elrom-train run first"});
  }
  const auto earlier = model::BundleReader(current).info().cases;
  RetrainReport report{.cases_before = earlier.size(), .seconds_from_nothing = recorded_seconds(folder)};
  const auto held_out_before = held_out_so_far(folder);
  const auto begin = Clock::now();
  Study study(folder, settings, toolbox, log, stop);
  tell_changed_split(study, earlier, held_out_before, log);
  study.reuse_plans_of(earlier);
  study.begin_at(current);
  study.fit(candidate);
  report.seconds = since(begin);
  report.cases_after = study.cases().n_cases();
  report.on_held_out_cases = !study.held_out().empty();
  report.error_before = error_of(current, study);
  report.error_after = error_of(candidate, study);
  report.promoted = report.error_after <= report.error_before;
  if (report.promoted)
    std::filesystem::rename(candidate, current);
  else
    std::filesystem::remove(candidate);
  if (compare) report.seconds_from_nothing = seconds_from_nothing(folder, settings, toolbox, log, stop);
  return report;
}

std::string to_json(const RetrainReport& report) {
  auto json = io::json_head<Json>(io::kinds::retrain);
  const auto& full = report.seconds_from_nothing;
  json.update({{"cases_before", report.cases_before},
               {"cases_after", report.cases_after},
               {"seconds", report.seconds},
               {"seconds_from_nothing", full ? Json(*full) : Json()},
               {"error_before", report.error_before},
               {"error_after", report.error_after},
               {"judged_on", report.on_held_out_cases ? "held-out cases" : "cross-validation"},
               {"promoted", report.promoted}});
  return json.dump(1) + "\n";
}

}  // namespace elrom::study
