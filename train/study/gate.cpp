#include "elrom/study/gate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/study/scores.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Index;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double far_too_much = 10;  // tolerances

std::vector<std::string> names_of(const field::SnapshotStore& store, const std::vector<std::size_t>& rows) {
  std::vector<std::string> names;
  for (const auto row : rows) names.push_back(store.cases()[row].inputs.name);
  return names;
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// Predictions of one field, (rows, n_cells).
MatrixF predict(const std::filesystem::path& bundle, const std::string& field, const MatrixD& inputs,
                int n_threads) {
  const model::Predictor predictor(bundle, {.fields = {field}});
  MatrixF values(inputs.rows(), static_cast<Index>(predictor.size()));
  model::Predictor::Scratch scratch;
  for (Index i = 0; i < inputs.rows(); ++i)
    predictor.predict({inputs.row(i).data(), static_cast<std::size_t>(inputs.cols())},
                      {values.row(i).data(), predictor.size()}, {}, scratch, n_threads);
  return values;
}

std::span<const float> row(const MatrixF& values, Index i) {
  return {values.row(i).data(), static_cast<std::size_t>(values.cols())};
}

bool has_field(const std::vector<field::FieldInfo>& fields, const std::string& name) {
  return std::ranges::find(fields, name, &field::FieldInfo::name) != fields.end();
}

std::vector<std::string> common_fields(const model::BundleInfo& a, const model::BundleInfo& b,
                                       const field::SnapshotStore& store) {
  std::vector<std::string> names;
  for (const auto& info : b.fields)
    if (has_field(a.fields, info.name) && has_field(store.fields(), info.name)) names.push_back(info.name);
  return names;
}

double dot(const MatrixF& a, Index i, const MatrixF& b, Index j) {
  return a.row(i).cast<double>().dot(b.row(j).cast<double>());
}

/// Sum of squared errors of each row.
std::vector<double> squared_errors(const MatrixF& truth, const MatrixF& predicted) {
  std::vector<double> errors;
  for (Index i = 0; i < truth.rows(); ++i)
    errors.push_back(math::squared_distance(row(truth, i), row(predicted, i)));
  return errors;
}

double total(const std::vector<double>& values) { return math::sum(values); }

/// sum over cells of squared departures from the training mean, of all rows of the truth.
double departure_of(const field::SnapshotStore& store, const std::string& field,
                    const std::vector<std::size_t>& building, const MatrixF& truth) {
  const auto statistics = training_statistics(store.read(field, building), store.mesh().n_columns);
  double sum = 0;
  for (Index i = 0; i < truth.rows(); ++i)
    sum += error_sums(row(truth, i), row(truth, i), statistics).departure;
  return sum;
}

/// Deviations of repeated runs, and by how much each set counts in each of the scored cases.
struct Noise {
  MatrixF deviations;               // (n_runs, n_cells)
  std::vector<std::size_t> set_of;  // (n_runs)
  MatrixD weight;                   // (n_sets, n_scored), of a squared projection

  Noise(const field::SnapshotStore& store, const std::string& field, const JudgedCases& judged) {
    const auto load_of = [&](std::size_t i) { return store.cases()[i].inputs.load; };
    std::vector<double> energies, measured, loads;
    for (const auto i : judged.scored) loads.push_back(load_of(i));
    Index n_runs = 0;
    for (const auto& set : judged.repeats) n_runs += static_cast<Index>(set.size());
    deviations.resize(n_runs, static_cast<Index>(store.mesh().n_cells()));
    for (const auto& set : judged.repeats) {
      const MatrixF runs = store.read(field, set);
      const Eigen::RowVectorXf mean = runs.colwise().mean();
      deviations.middleRows(static_cast<Index>(set_of.size()), runs.rows()) = runs.rowwise() - mean;
      set_of.insert(set_of.end(), set.size(), energies.size());
      energies.push_back(noise_energy(runs));
      measured.push_back(load_of(set.front()));
    }
    const auto at_loads = noise_at_loads(measured, energies, loads);
    const auto n_sets = static_cast<double>(energies.size());
    weight.resize(static_cast<Index>(energies.size()), static_cast<Index>(loads.size()));
    for (std::size_t s = 0; s < energies.size(); ++s)
      for (std::size_t i = 0; i < loads.size(); ++i)
        weight(static_cast<Index>(s), static_cast<Index>(i)) =
            energies[s] > 0
                ? at_loads[i] / energies[s] / n_sets / static_cast<double>(judged.repeats[s].size() - 1)
                : 0.0;
  }

  /// E (d . e)^2 in the scored case i.
  [[nodiscard]] double projected(const MatrixF& difference, Index i) const {
    double sum = 0;
    for (std::size_t r = 0; r < set_of.size(); ++r) {
      const double p = dot(difference, i, deviations, static_cast<Index>(r));
      sum += weight(static_cast<Index>(set_of[r]), i) * p * p;
    }
    return sum;
  }
};

/// The same from the errors of the better model on the other cases (on this one, where it is the only one).
double projected_on_errors(const MatrixF& difference, Index i, const MatrixF& errors) {
  if (errors.rows() == 1) return std::pow(dot(difference, i, errors, i), 2);
  double sum = 0;
  for (Index j = 0; j < errors.rows(); ++j)
    if (j != i) sum += std::pow(dot(difference, i, errors, j), 2);
  return sum / static_cast<double>(errors.rows() - 1);
}

Change change_of(const FieldVerdict& one, const GateSettings& settings) {
  const double growth = one.after - one.before;
  if (!std::isfinite(one.after)) return std::isfinite(one.before) ? Change::worse : Change::same;
  const double enough = std::isfinite(one.scatter) ? settings.deviations * one.scatter : 0.0;
  if (growth > far_too_much * settings.tolerance) return Change::worse;
  if (growth > settings.tolerance && growth > enough) return Change::worse;
  return growth < -enough && growth < 0 ? Change::better : Change::same;
}

FieldVerdict verdict_of(const std::string& field, double before, double after, double departure,
                        double variance, const GateSettings& settings) {
  FieldVerdict one{
      .field = field, .before = math::nrmse(before, departure, 0), .after = math::nrmse(after, departure, 0)};
  const double sum = departure * (one.before + one.after);
  one.scatter = sum > 0 ? std::sqrt(variance) / sum : 0.0;
  one.change = change_of(one, settings);
  return one;
}

FieldVerdict on_held_out(const std::string& field, const std::filesystem::path& present,
                         const std::filesystem::path& candidate, const GateCases& cases,
                         const JudgedCases& judged, const GateSettings& settings, int n_threads) {
  const auto inputs = cases.store.inputs(judged.scored);
  const MatrixF truth = cases.store.read(field, judged.scored);
  const MatrixF before = predict(present, field, inputs, n_threads),
                after = predict(candidate, field, inputs, n_threads);
  const auto errors_before = squared_errors(truth, before), errors_after = squared_errors(truth, after);
  const MatrixF difference = after - before;
  double variance = 0;
  if (judged.repeats.empty()) {
    const bool better = total(errors_after) < total(errors_before);
    const MatrixF errors = better ? truth - after : truth - before;
    for (Index i = 0; i < truth.rows(); ++i) variance += 4 * projected_on_errors(difference, i, errors);
  } else {
    const Noise noise(cases.store, field, judged);
    for (Index i = 0; i < truth.rows(); ++i) variance += 4 * noise.projected(difference, i);
  }
  return verdict_of(field, total(errors_before), total(errors_after),
                    departure_of(cases.store, field, cases.building, truth), variance, settings);
}

/// Squared errors of the bundle's own cross-validation by case; empty where it keeps none.
std::vector<double> kept_errors(const Json& accuracy, const std::string& field, std::size_t n_cases) {
  std::vector<double> errors;
  if (!accuracy.contains(field) || !accuracy[field].contains("squared_errors")) return errors;
  for (const auto& value : accuracy[field]["squared_errors"])
    errors.push_back(value.is_number() ? value.get<double>() : unknown);
  return errors.size() == n_cases ? errors : std::vector<double>();
}

double kept_nrmse(const Json& accuracy, const std::string& field) {
  const auto value = accuracy.contains(field) ? accuracy[field].value("nrmse", Json()) : Json();
  return value.is_number() ? value.get<double>() : 1.0;
}

class CrossValidation {
 public:
  CrossValidation(const model::BundleInfo& present, const model::BundleInfo& candidate,
                  const GateCases& cases)
      : before_(Json::parse(present.accuracy_json)),
        after_(Json::parse(candidate.accuracy_json)),
        n_before_(present.cases.size()),
        n_after_(candidate.cases.size()),
        cases_(cases) {
    for (std::size_t i = 0; i < present.cases.size(); ++i) {
      const auto found = std::ranges::find(candidate.cases, present.cases[i]);
      const auto there = cases.store.find(present.cases[i]);
      if (found == candidate.cases.end() || there.size() != 1) continue;
      common_.push_back({i, static_cast<std::size_t>(found - candidate.cases.begin()), there.front()});
    }
  }

  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::size_t> rows;
    for (const auto& one : common_) rows.push_back(one.row);
    return names_of(cases_.store, rows);
  }
  [[nodiscard]] bool is_paired(const std::string& field) const {
    return common_.size() > 2 && !kept_errors(before_, field, n_before_).empty() &&
           !kept_errors(after_, field, n_after_).empty();
  }

  [[nodiscard]] FieldVerdict judge(const std::string& field, const GateSettings& settings) const {
    if (!is_paired(field)) {
      FieldVerdict one{.field = field,
                       .before = kept_nrmse(before_, field),
                       .after = kept_nrmse(after_, field),
                       .scatter = unknown};
      one.change = change_of(one, settings);
      return one;
    }
    const auto before = kept_errors(before_, field, n_before_), after = kept_errors(after_, field, n_after_);
    std::vector<std::size_t> rows;
    math::RunningMoments differences;
    double sum_before = 0, sum_after = 0;
    for (const auto& one : common_) {
      rows.push_back(one.row);
      sum_before += before[one.before];
      sum_after += after[one.after];
      differences.add(after[one.after] - before[one.before]);
    }
    const auto n = static_cast<double>(common_.size());
    const MatrixF truth = cases_.store.read(field, rows);
    return verdict_of(field, sum_before, sum_after, departure_of(cases_.store, field, cases_.building, truth),
                      n * n / (n - 1) * differences.variance(), settings);
  }

 private:
  struct Common {
    std::size_t before, after, row;
  };
  Json before_, after_;
  std::size_t n_before_, n_after_;
  const GateCases& cases_;
  std::vector<Common> common_;
};

void add_mean(GateVerdict& verdict, const GateSettings& settings) {
  auto& mean = verdict.mean;
  const auto n = static_cast<double>(verdict.fields.size());
  for (const auto& one : verdict.fields) {
    mean.before += one.before / n;
    mean.after += one.after / n;
    mean.scatter += one.scatter / n;
  }
  mean.change = change_of(mean, settings);
  verdict.passed = verdict.what_is_worse().empty();
}

bool comparable(const model::BundleReader& bundle, const field::SnapshotStore& store) {
  return bundle.mesh_digest() == store.mesh().digest() &&
         bundle.info().schema.names() == store.schema().names();
}

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

std::string row_of(const FieldVerdict& one, const std::string& name) {
  return fmt::format(
      "{:<24} {:>9} {:>9} {:>9}  {}\n", name, base::rounded(one.before, 3), base::rounded(one.after, 3),
      std::isfinite(one.scatter) ? base::rounded(one.scatter, 2) : "not known", name_of(one.change));
}

}  // namespace

std::string_view name_of(Change change) {
  return change == Change::better ? "better" : change == Change::worse ? "worse" : "the same";
}

std::vector<std::string> GateVerdict::what_is_worse() const {
  std::vector<std::string> names;
  for (const auto& one : fields)
    if (one.change == Change::worse) names.push_back(one.field);
  if (mean.change == Change::worse) names.emplace_back("the mean over fields");
  for (const auto& field : missing) names.push_back("no " + field);
  return names;
}

std::optional<GateVerdict> judge(const std::filesystem::path& present, const std::filesystem::path& candidate,
                                 const GateCases& cases, const GateSettings& settings, int n_threads) {
  const model::BundleReader before(present), after(candidate);
  if (!comparable(before, cases.store) || !comparable(after, cases.store)) return std::nullopt;
  const auto fields = common_fields(before.info(), after.info(), cases.store);
  if (fields.empty()) return std::nullopt;
  auto judged = judged_cases(cases.store, cases.held_out);
  std::erase_if(judged.scored, [&](std::size_t i) {
    const auto& name = cases.store.cases()[i].inputs.name;
    return holds(before.info().cases, name) || holds(after.info().cases, name);
  });
  GateVerdict verdict;
  for (const auto& info : before.info().fields)
    if (!has_field(after.info().fields, info.name)) verdict.missing.push_back(info.name);
  if (!judged.scored.empty()) {
    verdict.judged_on = "held-out cases";
    verdict.scatter_from = judged.repeats.empty() ? "errors" : "repeated runs";
    verdict.cases = names_of(cases.store, judged.scored);
    for (const auto& field : fields)
      verdict.fields.push_back(on_held_out(field, present, candidate, cases, judged, settings, n_threads));
  } else {
    const CrossValidation validation(before.info(), after.info(), cases);
    verdict.judged_on = "cross-validation";
    verdict.scatter_from = validation.is_paired(fields.front()) ? "cases" : "none";
    verdict.cases = validation.names();
    for (const auto& field : fields) verdict.fields.push_back(validation.judge(field, settings));
  }
  add_mean(verdict, settings);
  return verdict;
}

std::string to_json(const GateVerdict& verdict) {
  Json json{{"judged_on", verdict.judged_on},
            {"scatter_from", verdict.scatter_from},
            {"cases", verdict.cases},
            {"before", number_or_null(verdict.mean.before)},
            {"after", number_or_null(verdict.mean.after)},
            {"scatter", number_or_null(verdict.mean.scatter)},
            {"verdict", name_of(verdict.mean.change)},
            {"passed", verdict.passed},
            {"missing", verdict.missing}};
  json["fields"] = Json::array();
  for (const auto& one : verdict.fields)
    json["fields"].push_back({{"field", one.field},
                              {"before", number_or_null(one.before)},
                              {"after", number_or_null(one.after)},
                              {"scatter", number_or_null(one.scatter)},
                              {"verdict", name_of(one.change)}});
  return json.dump();
}

std::string in_words(const GateVerdict& verdict) {
  auto text =
      fmt::format("{:<24} {:>9} {:>9} {:>9}  NRMSE on {} {}\n", "field", "present", "new", "scatter",
                  verdict.cases.size(),
                  verdict.judged_on == "held-out cases" ? "held-out cases" : "cases, cross-validated");
  for (const auto& one : verdict.fields) text += row_of(one, one.field);
  text += row_of(verdict.mean, "mean");
  return text;
}

}  // namespace elrom::study
