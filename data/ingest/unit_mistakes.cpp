#include "unit_mistakes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/operating_line.hpp"
#include "robust.hpp"

namespace elrom::ingest {
namespace {

constexpr std::size_t fewest_cases = 8;  // to compare cases with each other
// In units of the features' usual scatter (the 90th percentile of the others' residuals). What is far grows
// where few cases tell the scatter:
constexpr double suspicious_residual = 2.0;  // hardly a case of a healthy set lies so far out ...
constexpr double healthy_residual = 1.7;     // ... and nearly all within this
constexpr double wild_residual = 8.0;        // of a measure of the fields: told even when no unit explains it
constexpr double least_scatter = 0.02;       // 2 %, where cases agree almost exactly
constexpr double least_gain = 3.0;           // by which a correction must lower the sum of squares
// Where an even spread ends, in distances of its 90th percentile from its middle: 1.25, and more where few
// cases tell that percentile.
constexpr double even_end = 1.75;
constexpr double most_square = 30.0;  // a feature far out counts no more than this

// --- corrections

struct Slip {
  double factor, offset;
  std::string description;
};

/// Slips between any two units of a dimension, each numeric change once; those that involve `usual` come
/// first, and give the description.
std::vector<Slip> slips_of(const std::string& si, const std::string& usual) {
  std::vector<Slip> slips;
  const auto add = [&](const std::string& meant, const std::string& taken) {
    const auto& a = base::unit(meant);
    const auto& b = base::unit(taken);
    // stored = b.to_si(x), and a.to_si(x) is right.
    const double factor = a.factor / b.factor, offset = a.offset - factor * b.offset;
    const bool nothing = std::abs(std::log(factor)) < 1e-9 && std::abs(offset) < 1e-9;
    const bool known = std::any_of(slips.begin(), slips.end(), [&](const Slip& s) {
      return std::abs(std::log(s.factor / factor)) < 1e-9 && std::abs(s.offset - offset) < 1e-6;
    });
    if (!nothing && !known) slips.push_back({factor, offset, "values in " + meant + " taken for " + taken});
  };
  const auto units = base::units_of(si);
  for (const auto& other : units) {
    add(other, usual);
    add(usual, other);
  }
  for (const auto& a : units) {
    for (const auto& b : units) add(a, b);
  }
  return slips;
}

void add_group(std::vector<Correction>& corrections, const std::string& name, const std::string& si,
               const std::string& usual, const std::vector<std::size_t>& inputs,
               const std::vector<std::string>& fields) {
  if (inputs.size() + fields.size() == 0) return;
  for (const auto& slip : slips_of(si, usual)) {
    corrections.push_back({name, slip.description, slip.factor, slip.offset, inputs, fields});
  }
}

std::vector<std::string> fields_like(std::span<const std::string> fields, std::string_view pattern) {
  std::vector<std::string> found;
  for (const auto& name : fields) {
    if (base::matches(name, pattern)) found.push_back(name);
  }
  return found;
}

// --- comparison

/// How far below the usual a value may lie without a mistake, as a logarithm; 0: its scatter tells. A
/// quantity that is spread evenly down to near zero, as a designed input can be, has no lower end in
/// logarithms. So where ratios to the usual are less skewed than their logarithms, the end is that of an even
/// spread.
double lower_end(const std::vector<double>& residuals) {
  const std::array shares{0.1, 0.5, 0.9};
  std::array<double, 3> logs{}, ratios{};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    logs[i] = quantile(residuals, shares[i]);
    ratios[i] = std::exp(logs[i]);
  }
  const auto skewness = [](const std::array<double, 3>& q) {
    return std::abs(q[2] + q[0] - 2 * q[1]) / std::max(q[2] - q[0], 1e-12);
  };
  if (skewness(logs) <= skewness(ratios)) return 0;
  const double end = ratios[1] - even_end * (ratios[2] - ratios[1]);
  return end > 0 ? std::log(end) : -std::numeric_limits<double>::infinity();
}

/// The usual dependence of every feature on the load, learned from all cases.
class Usual {
 public:
  Usual(const CaseFeatures& features, std::span<const CaseSummary> cases)
      : features_(features), rows_(evaluate_all(features, cases)), load_(features, rows_) {
    std::vector<double> loads;
    for (const auto& row : rows_) loads.push_back(load_.of(row));
    for (std::size_t k = 0; k < features.infos().size(); ++k) {
      std::vector<double> column;
      for (const auto& row : rows_) column.push_back(row[k]);
      auto line = robust_line(loads, column, fewest_cases);
      line.scatter = std::max(line.scatter, least_scatter);
      if (has_any_sign(k, cases)) line.known = false;
      std::vector<double> rest;
      for (std::size_t i = 0; i < column.size(); ++i)
        if (std::isfinite(column[i])) rest.push_back(column[i] - line.at(loads[i]));
      lower_ends_.push_back(line.known ? lower_end(rest) : 0);
      lines_.push_back(line);
    }
  }

  /// Residuals in units of the usual scatter; 0 where nothing is known.
  [[nodiscard]] std::vector<double> residuals(const CaseSummary& one, const Correction* correction) const {
    const auto row = features_.evaluate(one, correction);
    const double load = load_.of(row);
    std::vector<double> result(row.size(), 0.0);
    for (std::size_t k = 0; k < row.size(); ++k) {
      const auto& line = lines_[k];
      if (!line.known || !std::isfinite(row[k])) continue;
      const double rest = row[k] - line.at(load);
      result[k] = rest / line.scatter;
      if (rest > lower_ends_[k]) result[k] = std::max(result[k], -1.0);
    }
    return result;
  }

 private:
  /// A measure that can be negative is near zero in some cases, and its logarithm then anything. One negative
  /// case may be a mistake of its own.
  static bool has_any_sign(std::size_t feature, std::span<const CaseSummary> cases) {
    const auto n_inputs = cases[0].schema.size();
    if (feature < n_inputs || feature >= n_inputs + n_measures) return false;
    const auto n_negative = std::ranges::count_if(
        cases, [&](const CaseSummary& one) { return one.measures[feature - n_inputs] < 0; });
    return n_negative > 1;
  }

  static std::vector<std::vector<double>> evaluate_all(const CaseFeatures& features,
                                                       std::span<const CaseSummary> cases) {
    std::vector<std::vector<double>> rows;
    for (const auto& one : cases) rows.push_back(features.evaluate(one));
    return rows;
  }

  const CaseFeatures& features_;
  std::vector<std::vector<double>> rows_;
  LoadProxy load_;
  std::vector<RobustLine> lines_;
  std::vector<double> lower_ends_;  // logarithms; 0: the scatter alone judges
};

double sum_of_squares(const std::vector<double>& residuals) {
  double sum = 0;
  for (const double r : residuals) sum += std::min(r * r, most_square);
  return sum;
}

std::size_t farthest(const std::vector<double>& residuals) {
  const auto at = std::max_element(residuals.begin(), residuals.end(),
                                   [](double a, double b) { return std::abs(a) < std::abs(b); });
  return static_cast<std::size_t>(at - residuals.begin());
}

/// The correction that brings the case best back among the others, if one does.
const Correction* best_correction(const Usual& usual, const CaseFeatures& features, const CaseSummary& one,
                                  const std::vector<Correction>& corrections,
                                  const std::vector<double>& residuals, double suspicious) {
  const double before = sum_of_squares(residuals);
  const Correction* best = nullptr;
  double best_sum = before - least_gain;
  for (const auto& correction : corrections) {
    const auto touched = features.touched(correction);
    const bool suspected = std::any_of(touched.begin(), touched.end(),
                                       [&](std::size_t k) { return std::abs(residuals[k]) > suspicious; });
    if (!suspected) continue;
    const auto after = usual.residuals(one, &correction);
    const bool healthy = std::all_of(touched.begin(), touched.end(),
                                     [&](std::size_t k) { return std::abs(after[k]) < healthy_residual; });
    const double sum = sum_of_squares(after);
    if (healthy && sum < best_sum) {
      best = &correction;
      best_sum = sum;
    }
  }
  return best;
}

std::vector<UnitMistake> compare_with_others(std::span<const CaseSummary> cases, const CaseFeatures& features,
                                             const std::vector<Correction>& corrections) {
  std::vector<UnitMistake> mistakes;
  const Usual usual(features, cases);
  const double growth = model::growth_for_few(cases.size());
  const double suspicious = growth * suspicious_residual, wild = growth * wild_residual;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto residuals = usual.residuals(cases[i], nullptr);
    if (std::abs(residuals[farthest(residuals)]) <= suspicious) continue;
    if (const auto* cause = best_correction(usual, features, cases[i], corrections, residuals, suspicious)) {
      mistakes.push_back({i, cause->quantity, cause->description, true});
      continue;
    }
    // Inputs have a test of their own (far_inputs).
    auto of_fields = residuals;
    std::fill_n(of_fields.begin(), cases[i].schema.size(), 0.0);
    const auto worst = farthest(of_fields);
    if (std::abs(of_fields[worst]) > wild) {
      mistakes.push_back({i, features.infos()[worst].name,
                          "far from the other cases at this load (" +
                              base::rounded(std::abs(of_fields[worst]), 2) + " times their usual scatter)",
                          false});
    }
  }
  return mistakes;
}

/// What lies far from what the case's other inputs make usual, by the guard's own test.
std::vector<UnitMistake> far_inputs(std::span<const CaseSummary> cases) {
  const auto n = static_cast<Eigen::Index>(cases.size());
  const auto& schema = cases[0].schema;
  MatrixD inputs(n, static_cast<Eigen::Index>(schema.size()));
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& values = cases[static_cast<std::size_t>(i)].inputs;
    if (values.size() != schema.size()) return {};
    inputs.row(i) = Eigen::Map<const Eigen::RowVectorXd>(values.data(), inputs.cols());
  }
  std::vector<UnitMistake> mistakes;
  const auto line = inputs.allFinite() ? model::OperatingLine(inputs) : model::OperatingLine();
  if (!line.knows()) return mistakes;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto usual = line.left_out(i);
    const auto distance = [&](std::size_t k) { return usual[k].distance(cases[i].inputs[k]); };
    const auto all = math::all_rows(schema.size());
    const auto worst = *std::ranges::max_element(all, {}, distance);
    if (distance(worst) <= line.far_limit()) continue;
    mistakes.push_back({i, schema[worst].name,
                        model::unusual_text(schema[worst], cases[i].inputs[worst], usual[worst]), false});
  }
  return mistakes;
}

/// The first ratio of a case that physics does not allow.
std::optional<UnitMistake> against_physics(const CaseSummary& one, std::size_t i_case,
                                           const CaseFeatures& features) {
  const auto values = features.evaluate(one);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const auto& info = features.infos()[k];
    if (!info.range || !std::isfinite(values[k])) continue;
    if (values[k] >= info.range->first && values[k] <= info.range->second) continue;
    return UnitMistake{i_case, info.name,
                       "impossible: " + base::rounded(std::exp(values[k]), 3) + ", plausible " +
                           base::rounded(std::exp(info.range->first), 3) + " to " +
                           base::rounded(std::exp(info.range->second), 3),
                       false};
  }
  return std::nullopt;
}

}  // namespace

std::vector<Correction> possible_corrections(const field::InputSchema& schema,
                                             std::span<const std::string> fields) {
  std::vector<Correction> corrections;
  std::vector<std::size_t> flows;
  std::string flow_unit = "kg/s";
  for (std::size_t i = 0; i < schema.size(); ++i) {
    add_group(corrections, schema[i].name, schema[i].unit, schema[i].display_unit, {i}, {});
    if (schema[i].unit == "kg/s") {
      flows.push_back(i);
      flow_unit = schema[i].display_unit;
    }
  }
  for (const auto& name : fields) {
    const auto unit = field::field_info(name).unit;
    add_group(corrections, name, unit, unit, {}, {name});
  }
  add_group(corrections, "all gas flows", "kg/s", flow_unit, flows, {});
  add_group(corrections, "all gas velocities", "m/s", "m/s", {}, fields_like(fields, "gas_velocity_?"));
  add_group(corrections, "all solid velocities", "m/s", "m/s", {}, fields_like(fields, "solid_velocity_?"));
  add_group(corrections, "all velocities", "m/s", "m/s", {}, fields_like(fields, "*_velocity_?"));
  return corrections;
}

std::vector<UnitMistake> find_unit_mistakes(std::span<const CaseSummary> cases) {
  if (cases.empty()) return {};
  const CaseFeatures features(cases[0].schema);
  std::vector<UnitMistake> mistakes;
  const auto told = [&](std::size_t i) {
    return std::any_of(mistakes.begin(), mistakes.end(), [&](const UnitMistake& m) { return m.i_case == i; });
  };
  if (cases.size() >= fewest_cases) {
    mistakes = compare_with_others(cases, features, possible_corrections(cases[0].schema, cases[0].fields));
    for (auto& mistake : far_inputs(cases))
      if (!told(mistake.i_case)) mistakes.push_back(std::move(mistake));
  }
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (told(i)) continue;
    if (auto mistake = against_physics(cases[i], i, features)) mistakes.push_back(std::move(*mistake));
  }
  return mistakes;
}

}  // namespace elrom::ingest
