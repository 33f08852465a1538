#include "elrom/ingest/check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "outliers.hpp"
#include "physics_checks.hpp"
#include "unit_mistakes.hpp"

namespace elrom::ingest {
namespace {

constexpr base::EnumNames<Severity, 3> severities{
    "severity", {{Severity::note, "note"}, {Severity::suspicious, "suspicious"}, {Severity::wrong, "wrong"}}};
constexpr std::size_t fewest_for_dead_cells = 3;

bool same_layout(const CaseSummary& a, const CaseSummary& b) {
  if (a.fields != b.fields || a.schema.size() != b.schema.size()) return false;
  for (std::size_t i = 0; i < a.schema.size(); ++i) {
    if (a.schema[i].name != b.schema[i].name || a.schema[i].unit != b.schema[i].unit) return false;
  }
  return true;
}

void add_cells(const CaseSummary& one, std::vector<Finding>& found) {
  const auto place = [&](const BadCell& bad) {
    return fmt::format("{} cell{} of {}, the first is cell {} with {}", bad.count, bad.count == 1 ? "" : "s",
                       bad.field, bad.cell, base::rounded(bad.value));
  };
  for (const auto& bad : one.not_finite) {
    found.push_back(
        {"not_finite", Severity::wrong, one.name, bad.field, bad.cell, "not finite: " + place(bad)});
  }
  for (const auto& bad : one.out_of_bounds) {
    found.push_back({"out_of_bounds", Severity::suspicious, one.name, bad.field, bad.cell,
                     "outside the physical bounds: " + place(bad)});
  }
}

void add_mistakes(std::span<const CaseSummary> cases, std::vector<Finding>& found) {
  for (const auto& mistake : find_unit_mistakes(cases)) {
    found.push_back({mistake.certain_cause ? "unit" : "far_input",
                     mistake.certain_cause ? Severity::wrong : Severity::suspicious,
                     cases[mistake.i_case].name, mistake.quantity, -1,
                     mistake.certain_cause ? "looks like " + mistake.explanation : mistake.explanation});
  }
}

void add_physics(std::span<const CaseSummary> cases, std::vector<Finding>& found) {
  for (const auto& one : judge_physics(cases)) {
    const auto& reading = one.reading;
    found.push_back({reading.check, one.impossible ? Severity::wrong : Severity::suspicious,
                     cases[one.i_case].name, reading.quantity, -1, in_words(one), reading.value, one.low,
                     one.high});
  }
}

void add_twins(std::span<const CaseSummary> cases, std::vector<Finding>& found) {
  for (const auto& twin : find_twins(cases)) {
    const auto& other = cases[twin.first].name;
    found.push_back(
        {twin.exact ? "duplicate" : "near_duplicate", twin.exact ? Severity::wrong : Severity::suspicious,
         cases[twin.second].name, "", -1,
         twin.exact ? fmt::format("all fields equal those of {}", other)
                    : fmt::format("fields nearly equal those of {} ({:.1f} % of the usual distance between "
                                  "cases)",
                                  other, 100 * twin.distance)});
  }
}

void add_outliers(std::span<const CaseSummary> cases, std::vector<Finding>& found) {
  for (const auto& outlier : find_outliers(cases)) {
    found.push_back({"outlier", Severity::suspicious, cases[outlier.i_case].name, outlier.field, -1,
                     fmt::format("lies apart from the other cases: {} times the usual distance in POD space, "
                                 "others up to {}",
                                 base::rounded(outlier.distance, 2), base::rounded(outlier.limit, 2)),
                     outlier.distance, 0, outlier.limit});
  }
}

void add_dead_inputs(std::span<const CaseSummary> cases, std::vector<Finding>& found) {
  if (cases.size() < fewest_for_dead_cells) return;
  for (std::size_t i = 0; i < cases[0].schema.size(); ++i) {
    const bool dead = std::all_of(cases.begin(), cases.end(), [&](const CaseSummary& one) {
      return i < one.inputs.size() && i < cases[0].inputs.size() && one.inputs[i] == cases[0].inputs[i];
    });
    if (!dead) continue;
    found.push_back({"dead_input", Severity::note, "", cases[0].schema[i].name, -1,
                     "the same value in every case: nothing can be learned from it"});
  }
}

/// Cases that can be compared with the first one; the others are told.
std::vector<CaseSummary> comparable(const std::vector<CaseSummary>& cases, std::vector<Finding>& found) {
  std::vector<CaseSummary> same;
  for (const auto& one : cases) {
    if (same_layout(one, cases.front())) {
      same.push_back(one);
    } else {
      found.push_back({"other_layout", Severity::suspicious, one.name, "", -1,
                       "has other inputs or other fields than " + cases.front().name});
    }
  }
  return same;
}

}  // namespace

std::string_view name_of(Severity severity) { return severities.name(severity); }

const std::vector<std::string>& finding_kinds() {
  static const std::vector<std::string> kinds{
      "out_of_bounds", "unit",        "far_input",      "duplicate",  "near_duplicate", "outlier",
      "mesh_cover",    "empty_field", "flow_direction", "continuity", "gas_balance",    "solids_inventory",
      "roughness"};
  return kinds;
}

CheckedCase view_of(const CfdCase& one, const field::Mesh* planes, const field::Furnace* furnace) {
  const auto& inputs = one.record.inputs;
  return {.name = inputs.name,
          .load = inputs.load,
          .schema = &one.schema,
          .inputs = inputs.values,
          .centre = &one.centre,
          .volume = one.volume,
          .fields = one.fields,
          .values = ConstMapF(one.values.data(), one.values.rows(), one.values.cols()),
          .mesh = planes,
          .furnace = furnace};
}

std::optional<field::Mesh> layers_of(const CfdCase& one) {
  const auto n = one.centre.rows();
  const auto z = one.centre.col(2);
  const double touch = 1e-5 * (z.maxCoeff() - z.minCoeff());  // exports keep centres as float32
  Eigen::Index n_columns = 1;
  while (n_columns < n && std::abs(z[n_columns] - z[0]) <= touch) ++n_columns;
  if (n % n_columns != 0 || n == n_columns) return std::nullopt;
  for (Eigen::Index i = 1; i < n; ++i) {
    const bool begins_layer = i % n_columns == 0;
    if (begins_layer ? z[i] <= z[i - 1] + touch : std::abs(z[i] - z[i - 1]) > touch) return std::nullopt;
  }
  return field::Mesh{.n_planes = static_cast<std::size_t>(n / n_columns),
                     .n_columns = static_cast<std::size_t>(n_columns),
                     .centre = one.centre,
                     .volume = one.volume};
}

CheckedCase view_of(const field::CaseRecord& record, const MatrixF& values, const field::Mesh& mesh,
                    const field::InputSchema& schema, std::span<const field::FieldInfo> fields,
                    const field::Furnace* furnace, std::optional<Coverage> coverage) {
  return {.name = record.inputs.name,
          .load = record.inputs.load,
          .schema = &schema,
          .inputs = record.inputs.values,
          .centre = &mesh.centre,
          .volume = mesh.volume,
          .fields = fields,
          .values = ConstMapF(values.data(), values.rows(), values.cols()),
          .mesh = &mesh,
          .furnace = furnace,
          .coverage = coverage,
          .resampling_error = record.resampling_error};
}

void Checker::add(const CheckedCase& view) {
  cases_.push_back(summarise(view));
  if (lowest_.size() == 0) {
    lowest_ = highest_ = view.values;
  } else if (lowest_.rows() == view.values.rows() && lowest_.cols() == view.values.cols()) {
    lowest_ = lowest_.cwiseMin(view.values);
    highest_ = highest_.cwiseMax(view.values);
  } else {
    same_mesh_ = false;
  }
}

void Checker::add(const field::SnapshotStore& store) {
  const auto& fields = store.fields();
  MatrixF values(static_cast<Eigen::Index>(fields.size()), static_cast<Eigen::Index>(store.mesh().n_cells()));
  for (std::size_t i = 0; i < store.n_cases(); ++i) {
    const std::size_t one[] = {i};
    const auto& record = store.cases()[i];
    try {
      for (std::size_t f = 0; f < fields.size(); ++f) {
        values.row(static_cast<Eigen::Index>(f)) = store.read(fields[f].name, one);
      }
      const auto& furnace = store.furnace();
      add(view_of(record, values, store.mesh(), store.schema(), fields, furnace ? &*furnace : nullptr));
    } catch (const InputError& error) {
      add_unreadable(record.inputs.name, error.what());
    }
  }
}

void Checker::add_unreadable(const std::string& name, const std::string& reason) {
  unreadable_.push_back({"unreadable", Severity::wrong, name, "", -1, reason});
}

void Checker::forget(const std::set<std::string>& names) {
  std::erase_if(cases_, [&](const CaseSummary& one) { return names.contains(one.name); });
}

void Checker::add_dead_cells(std::vector<Finding>& found) const {
  if (!same_mesh_ || cases_.size() < fewest_for_dead_cells) return;
  for (Eigen::Index f = 0; f < lowest_.rows(); ++f) {
    const auto dead = (lowest_.row(f).array() == highest_.row(f).array()).eval();
    const auto count = dead.count();
    if (count == 0) continue;
    Eigen::Index first = 0;
    dead.cast<int>().maxCoeff(&first);
    const bool all = count == dead.size();
    found.push_back(
        {"dead_cells", all ? Severity::suspicious : Severity::note, "",
         cases_.front().fields[static_cast<std::size_t>(f)], first,
         all ? "the field is the same in every case"
             : fmt::format("{} of {} cells have the same value in every case, the first is cell {}", count,
                           dead.size(), first)});
  }
}

std::vector<Finding> Checker::findings() const {
  auto found = unreadable_;
  for (const auto& one : cases_) add_cells(one, found);
  if (!cases_.empty()) {
    const auto same = comparable(cases_, found);
    add_mistakes(same, found);
    add_physics(same, found);
    add_twins(same, found);
    add_outliers(same, found);
    add_dead_inputs(same, found);
    add_dead_cells(found);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  return found;
}

std::vector<Finding> findings_on(std::span<const Finding> findings, std::string_view case_name) {
  std::vector<Finding> result;
  for (const auto& finding : findings) {
    if (finding.case_name == case_name && finding.severity != Severity::note) result.push_back(finding);
  }
  return result;
}

std::string line_of(const Finding& finding) {
  std::string line(name_of(finding.severity));
  line += ": ";
  if (!finding.case_name.empty()) line += finding.case_name + (finding.quantity.empty() ? ": " : ", ");
  if (!finding.quantity.empty()) line += finding.quantity + ": ";
  return line + finding.message;
}

}  // namespace elrom::ingest
