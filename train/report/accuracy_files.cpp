// The report as JSON and CSV. NaN has no JSON form: it becomes null.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/report/accuracy.hpp"
#include "json_number.hpp"

namespace elrom::report {
namespace {

Json interval_node(const std::optional<math::LikelyRange>& interval) {
  return interval ? Json{number(interval->low), number(interval->high)} : Json();
}

Json scores(const ErrorSums& sums) {
  return {{"nrmse", number(sums.nrmse())},
          {"rmse", number(sums.rmse())},
          {"r2", number(sums.r2())},
          {"standardised_mse", number(sums.standardised_mse())},
          {"cells", sums.n}};
}

Json method_on_field(const AccuracyReport& report, const FieldAccuracy& field, std::size_t m) {
  const auto& method = field.methods[m];
  Json node{{"method", report.methods[m].file.name}};
  if (!method.available) return node;
  node["kind"] = method.kind;
  if (!method.detail.empty()) node["detail"] = method.detail;
  node.update(scores(method.pooled));
  node["nrmse_without_noise"] = number(field.nrmse_without_noise(m));
  node["below_noise"] = field.below_noise(m);
  node["nrmse_averaged_truth"] = number(field.averaged_nrmse(m, math::all_rows(report.cases.size())));
  for (std::size_t i = 0; i < report.cases.size(); ++i) {
    Json of_case{{"case", report.cases[i].name}};
    of_case.update(scores(method.cases[i]));
    const auto& worst = method.worst[i];
    of_case["worst_cell"] = {{"cell", worst.cell.cell},
                             {"position_m", worst.position},
                             {"truth", number(worst.cell.truth)},
                             {"prediction", number(worst.cell.prediction)}};
    node["cases"].push_back(std::move(of_case));
  }
  return node;
}

Json coverage_of(const FieldAccuracy& field) {
  Json node = Json::array();
  for (std::size_t k = 0; k < field.coverage.size(); ++k) {
    Json measured = Json::array();
    double sum = 0;
    for (const double share : field.coverage[k]) {
      measured.push_back(number(share));
      sum += share;
    }
    node.push_back({{"promised", coverage_levels[k]},
                    {"measured", number(sum / static_cast<double>(field.coverage[k].size()))},
                    {"by_case", std::move(measured)}});
  }
  return node;
}

Json field_node(const AccuracyReport& report, const FieldAccuracy& field) {
  Json node{{"field", field.info.name}, {"unit", field.info.unit}, {"methods", Json::array()}};
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    node["methods"].push_back(method_on_field(report, field, m));
  if (const auto best = report.best_peer(field)) {
    const auto gain = report.gain(field);
    node["best_peer"] = report.methods[*best].file.name;
    node["gain_over_best_peer"] = number(gain.value);
    node["gain_interval"] = interval_node(gain.interval);
  }
  Json candidates = Json::array();
  for (const auto& candidate : field.choice.candidates)
    candidates.push_back({{"method", candidate.name},
                          {"nrmse", number(candidate.nrmse)},
                          {"weight", candidate.weight},
                          {"left_after", candidate.left_after}});
  node["choice"] = {{"nrmse", number(field.choice.nrmse)},
                    {"nrmse_by_band", number(field.choice.nrmse_by_band)},
                    {"scale", field.choice.scale.empty() ? Json() : Json(field.choice.scale)},
                    {"candidates", std::move(candidates)}};
  node["error_budget"] = {{"noise", !field.noise.empty() ? number(field.budget.noise) : Json()},
                          {"compression", number(field.budget.compression)},
                          {"regression", number(field.budget.regression)}};
  node["noise_nrmse"] = number(field.noise_nrmse);
  Json compression = Json::array();
  for (const double value : field.compression_nrmse) compression.push_back(number(value));
  node["compression_nrmse_by_modes"] = std::move(compression);
  node["coverage"] = coverage_of(field);
  for (const auto& submodel : field.submodels) {
    Json band{{"submodel", submodel.name}};
    band.update(scores(submodel.sums));
    node["submodels"].push_back(std::move(band));
  }
  return node;
}

Json case_node(const ScoredCase& scored) {
  Json node{{"case", scored.name},
            {"load", number(scored.load)},
            {"validity", model::name_of(scored.validity.verdict)},
            {"reason", scored.validity.reason},
            {"p_value", number(scored.validity.p_value)}};
  for (const auto& near : scored.validity.nearest)
    node["nearest"].push_back(
        {{"case", near.name}, {"load", number(near.load)}, {"distance", number(near.distance)}});
  node["audit_truth"] = Json::parse(model::to_json(scored.truth_audit));
  node["audit_prediction"] = Json::parse(model::to_json(scored.prediction_audit));
  return node;
}

/// null: some held-out case has no repeated run
Json averaged_node(const AccuracyReport& report) {
  if (!report.has_averaged_truth()) return {};
  Json node{{"runs", report.runs}};
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    const auto error = report.averaged_error(m);
    node["methods"].push_back({{"method", report.methods[m].file.name},
                               {"mean_nrmse", number(error.value)},
                               {"interval", interval_node(error.interval)}});
  }
  if (const auto best = report.best_averaged_peer()) {
    const auto gain = report.averaged_gain();
    node["best_single_peer"] = report.methods[*best].file.name;
    node["gain_over_best_single_peer"] = number(gain.value);
    node["gain_interval"] = interval_node(gain.interval);
  }
  return node;
}

Json method_node(const AccuracyReport& report, std::size_t m) {
  const auto& method = report.methods[m];
  return {{"method", method.file.name},
          {"bundle_digest", method.digest},
          {"simple_peer", method.file.is_peer},
          {"training_cases", method.training_cases.size()},
          {"other_training_cases", method.other_cases},
          {"leaked_cases", method.leaked_cases},
          {"fields_better_than_study", report.fields_better(m).size()},
          {"mean_nrmse", number(method.mean_nrmse)},
          {"mean_nrmse_without_noise", number(method.mean_nrmse_without_noise)},
          {"train_seconds", number(method.file.train_seconds)},
          {"open_ms", method.open_ms},
          {"predict_ms", method.predict_ms}};
}

// Held-out cases that any of the methods was trained on.
std::vector<std::string> leaked_cases(const AccuracyReport& report) {
  std::vector<std::string> leaked;
  for (const auto& scored : report.cases)
    if (std::ranges::any_of(report.methods, [&](const MethodSummary& method) {
          return std::ranges::find(method.leaked_cases, scored.name) != method.leaked_cases.end();
        }))
      leaked.push_back(scored.name);
  return leaked;
}

}  // namespace

std::string to_json(const AccuracyReport& report) {
  auto root = io::json_head<Json>(io::kinds::accuracy);
  const auto gain = report.gain();
  root.update({{"created", report.created},
               {"study", report.study.name},
               {"headline", headline(report)},
               {"training_cases", report.n_training},
               {"planes", report.n_planes},
               {"columns", report.n_columns},
               {"mean_nrmse", number(report.methods.front().mean_nrmse)},
               {"gain_over_best_single_peer", number(gain.value)},
               {"gain_interval", interval_node(gain.interval)},
               {"gain_interval_level", gain_level},
               {"gain_without_noise", number(report.gain_without_noise())},
               {"averaged_truth", averaged_node(report)},
               {"fields_at_or_below_every_simple_peer", report.fields_won()},
               {"fields_at_or_below_every_method", report.fields_won_against_all()},
               {"fields_below_noise", report.fields_below_noise()},
               {"leaked_cases", leaked_cases(report)},
               {"repeated_runs", report.repeats}});
  if (const auto best = report.best_peer()) root["best_single_peer"] = report.methods[*best].file.name;
  for (std::size_t k = 0; k < coverage_levels.size(); ++k)
    root["coverage"].push_back(
        {{"promised", coverage_levels[k]}, {"measured", number(report.mean_coverage(k))}});
  for (std::size_t m = 0; m < report.methods.size(); ++m) root["methods"].push_back(method_node(report, m));
  for (const auto& field : report.fields) root["fields"].push_back(field_node(report, field));
  for (const auto& scored : report.cases) root["cases"].push_back(case_node(scored));
  root["stage_seconds"] = report.study.stage_seconds;
  return root.dump(1) + '\n';
}

std::string to_csv(const AccuracyReport& report) {
  std::string text =
      "field,unit,method,case,load,nrmse,rmse,r2,standardised_mse,worst_x_m,worst_y_m,worst_z_m,worst_truth,"
      "worst_prediction\n";
  const auto write = [](double value) { return std::isfinite(value) ? base::number(value) : std::string(); };
  const auto of_sums = [&](const ErrorSums& s) {
    return fmt::format("{},{},{},{}", write(s.nrmse()), write(s.rmse()), write(s.r2()),
                       write(s.standardised_mse()));
  };
  for (const auto& field : report.fields)
    for (std::size_t m = 0; m < report.methods.size(); ++m) {
      const auto& method = field.methods[m];
      if (!method.available) continue;
      const auto start =
          fmt::format("{},{},{}", field.info.name, field.info.unit, report.methods[m].file.name);
      text += fmt::format("{},all,,{},,,,,\n", start, of_sums(method.pooled));
      for (std::size_t i = 0; i < report.cases.size(); ++i) {
        const auto& worst = method.worst[i];
        text += fmt::format("{},{},{},{},{},{},{},{},{}\n", start, report.cases[i].name,
                            write(report.cases[i].load), of_sums(method.cases[i]), write(worst.position[0]),
                            write(worst.position[1]), write(worst.position[2]), write(worst.cell.truth),
                            write(worst.cell.prediction));
      }
    }
  return text;
}

}  // namespace elrom::report
