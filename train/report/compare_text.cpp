// A comparison as a sentence, as a table for a terminal and as JSON.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/report/compare.hpp"
#include "json_number.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

using Verdict = Gain::Verdict;

std::vector<std::string> fields_with(const Comparison& comparison, Verdict verdict) {
  std::vector<std::string> names;
  for (const auto& field : comparison.fields)
    if (field.gain.verdict() == verdict) names.push_back(field_label(field.field));
  return names;
}

// "none", "2 (pressure, solid diameter)", "8"
std::string count_text(const std::vector<std::string>& names) {
  constexpr std::size_t most_named = 3;
  if (names.empty()) return "none";
  return std::to_string(names.size()) +
         (names.size() <= most_named ? " (" + base::join(names, ", ") + ")" : "");
}

std::string verdict_key(const Gain& gain) {
  return gain.verdict() == Verdict::better  ? "better"
         : gain.verdict() == Verdict::worse ? "worse"
                                            : "no_difference_shown";
}

Json to_node(const FieldComparison& one) {
  Json node{{"nrmse_a", number(one.a)}, {"nrmse_b", number(one.b)}, {"gain", number(one.gain.value)}};
  node["gain_interval"] =
      one.gain.interval ? Json{number(one.gain.interval->low), number(one.gain.interval->high)} : Json();
  node["verdict"] = verdict_key(one.gain);
  return node;
}

Json bundle_node(const Comparison& comparison, std::size_t m) {
  const auto& method = comparison.report.methods[m];
  return {{"path", (m == 0 ? comparison.a : comparison.b).string()},
          {"bundle_digest", method.digest},
          {"training_cases", method.training_cases.size()}};
}

std::string training_text(const AccuracyReport& report) {
  const auto &a = report.methods[0], &b = report.methods[1];
  const auto n_a = a.training_cases.size(), n_b = b.training_cases.size();
  if (!a.other_cases && !b.other_cases) return "";
  return n_a == n_b ? fmt::format(" A and B were each trained on {} cases, not the same.", n_a)
                    : fmt::format(" A was trained on {} cases, B on {}.", n_a, n_b);
}

// Cases that one of them knows under another name: their boundary conditions are those of a training case.
std::string leak_text(const AccuracyReport& report) {
  std::string text;
  for (const auto& method : report.methods)
    if (!method.leaked_cases.empty())
      text += fmt::format(" {} was trained on cases with the boundary conditions of {}: no test of it.",
                          method.file.name, base::join(method.leaked_cases, ", "));
  return text;
}

}  // namespace

std::string verdict_text(const Gain& gain) {
  return gain.verdict() == Verdict::better  ? "better"
         : gain.verdict() == Verdict::worse ? "worse"
                                            : "no difference shown";
}

std::string headline(const Comparison& comparison) {
  const auto& report = comparison.report;
  const auto& mean = comparison.mean;
  const auto better = fields_with(comparison, Verdict::better),
             worse = fields_with(comparison, Verdict::worse);
  const auto on = fmt::format("on {} {}", report.cases.size(), report.words.case_word(report.cases.size()));
  auto text = mean.gain.verdict() == Verdict::not_shown
                  ? "No difference shown between A and B " + on
                  : fmt::format("B is {} than A {}", verdict_text(mean.gain), on);
  text += fmt::format(": mean NRMSE {} and {}, B {} {}", score_text(mean.a), score_text(mean.b),
                      in_words(mean.gain), mean.gain.value >= 0 ? "below" : "above");
  text +=
      fmt::format("; of {} {} it is better in {}, worse in {}.", comparison.fields.size(),
                  comparison.fields.size() == 1 ? "field" : "fields", count_text(better), count_text(worse));
  return text + training_text(report) + leak_text(report);
}

std::string terminal_table(const Comparison& comparison) {
  const auto& report = comparison.report;
  auto text = fmt::format("\n  A: {}, {} training cases\n  B: {}, {} training cases\n\n",
                          comparison.a.string(), report.methods[0].training_cases.size(),
                          comparison.b.string(), report.methods[1].training_cases.size());
  const std::string line = "  " + std::string(88, '-') + '\n';
  text += fmt::format("  {:<24}{:>9}{:>9}   {:<26}{}\n", "field", "A", "B", "B's gain", "B is") + line;
  const auto row = [](const std::string& name, const FieldComparison& one) {
    return fmt::format("  {:<24}{:>9}{:>9}   {:<26}{}\n", name, score_text(one.a), score_text(one.b),
                       gain_text(one.gain), verdict_text(one.gain));
  };
  for (const auto& field : comparison.fields) text += row(field_label(field.field), field);
  text += line + row("mean", comparison.mean) +
          "  NRMSE: 0 is perfect, 1 is predicting the mean of A's training cases\n\n  " +
          headline(comparison) + '\n';
  if (!comparison.left_out.empty())
    text += "  Left out, since A or B was trained on them: " + base::join(comparison.left_out, ", ") + '\n';
  if (!comparison.missing.empty())
    text += "  Fields of A that B lacks: " + base::join(comparison.missing, ", ") + '\n';
  return text;
}

std::string to_json(const Comparison& comparison) {
  auto root = io::json_head<Json>(io::kinds::comparison);
  const auto& report = comparison.report;
  root.update({{"created", report.created},
               {"headline", headline(comparison)},
               {"a", bundle_node(comparison, 0)},
               {"b", bundle_node(comparison, 1)},
               {"gain_interval_level", gain_level},
               {"mean", to_node(comparison.mean)},
               {"fields", Json::array()},
               {"cases", Json::array()},
               {"left_out", comparison.left_out},
               {"missing_fields", comparison.missing}});
  for (const auto& field : comparison.fields) {
    Json node{{"field", field.field}};
    node.update(to_node(field));
    root["fields"].push_back(std::move(node));
  }
  for (std::size_t i = 0; i < report.cases.size(); ++i) {
    Json node{{"case", report.cases[i].name}, {"fields", Json::array()}};
    for (const auto& field : report.fields)
      node["fields"].push_back({{"field", field.info.name},
                                {"nrmse_a", number(field.methods[0].cases[i].nrmse())},
                                {"nrmse_b", number(field.methods[1].cases[i].nrmse())}});
    root["cases"].push_back(std::move(node));
  }
  return root.dump(1) + '\n';
}

}  // namespace elrom::report
