#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/methods/auto_method.hpp"
#include "names.hpp"
#include "page_parts.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using svg::escape;

/// A score that a table can show: smaller is better but for R2.
struct ScoreKind {
  std::string id, title, note;
  bool higher_is_better = false;
  bool has_mean = true;
  std::function<double(const AccuracyReport&, const FieldAccuracy&, std::size_t)> value;
};

std::vector<ScoreKind> score_kinds(const AccuracyReport& report) {
  const auto pooled = [](double (ErrorSums::*score)() const) {
    return [score](const AccuracyReport&, const FieldAccuracy& field, std::size_t m) {
      return field.methods[m].available ? (field.methods[m].pooled.*score)() : std::nan("");
    };
  };
  std::vector<ScoreKind> kinds{
      {"nrmse", "NRMSE", "Error over the error of predicting the training mean: 0 is perfect, 1 is no skill.",
       false, true, pooled(&ErrorSums::nrmse)}};
  if (!report.repeats.empty())
    kinds.push_back(
        {"clean", "Noise taken off",
         "NRMSE after the noise of the truth, measured by repeated runs, is taken off error and "
         "reference alike. Where it is larger than the error there is nothing to take it off from: "
         "below noise. The last row is over the fields where that is so of no method.",
         false, true, [](const AccuracyReport&, const FieldAccuracy& field, std::size_t m) {
           return field.nrmse_without_noise(m);
         }});
  kinds.push_back(
      {"mse", "Standardised MSE",
       "The source's figure: mean squared error in units of each column's variance over the training set.",
       false, true, pooled(&ErrorSums::standardised_mse)});
  kinds.push_back({"rmse", "RMSE", "In the field's own unit.", false, false, pooled(&ErrorSums::rmse)});
  kinds.push_back(
      {"r2", "R²",
       "Of all cells of all held-out cases about their one mean: high wherever the structure that all "
       "cases share is captured.",
       true, true, pooled(&ErrorSums::r2)});
  return kinds;
}

std::size_t best_of(const std::vector<double>& values, bool higher_is_better) {
  std::size_t best = values.size();
  for (std::size_t m = 0; m < values.size(); ++m)
    if (std::isfinite(values[m]) &&
        (best == values.size() || (higher_is_better ? values[m] > values[best] : values[m] < values[best])))
      best = m;
  return best;
}

std::string cell_text(const ScoreKind& kind, double value, const FieldAccuracy* field, std::size_t method) {
  if (kind.id == "clean" && field != nullptr && field->below_noise(method)) return "below noise";
  if (kind.id != "rmse") return score_text(value);
  const auto unit = field != nullptr ? shown_unit(field->info.name, field->info.unit) : ShownUnit{};
  return std::isfinite(value) ? value_text(value * unit.factor, unit.symbol) : "-";
}

std::string score_row(const std::string& name, const std::vector<double>& values, const ScoreKind& kind,
                      const FieldAccuracy* field, const std::string& notes) {
  // Below the noise, methods cannot be told apart.
  const bool has_best = kind.id != "clean" || field == nullptr || field->above_noise();
  const auto best = has_best ? best_of(values, kind.higher_is_better) : values.size();
  std::string cells;
  for (std::size_t m = 0; m < values.size(); ++m)
    cells += fmt::format("<td class=\"mark{}{}\">{}</td>", m == 0 ? " own" : "", m == best ? " best" : "",
                         cell_text(kind, values[m], field, m));
  return fmt::format("<tr{}><th>{}</th>{}{}</tr>", field == nullptr ? " class=\"sum\"" : "", escape(name),
                     cells, notes);
}

std::string answers_by(const FieldAccuracy& field) {
  const auto& own = field.methods[0];
  return own.detail.empty() ? method_label(own.kind) : "blend: " + own.detail;
}

// What stands to the right of the scores: the gain where the scores are NRMSE, and what answers.
std::string notes(const AccuracyReport& report, const ScoreKind& kind, const FieldAccuracy* field) {
  std::string cells;
  if (kind.id == "nrmse" && report.best_peer())
    cells += fmt::format("<td>{}</td>", gain_text(field != nullptr ? report.gain(*field) : report.gain()));
  return cells +
         fmt::format("<td class=\"text\">{}</td>", field != nullptr ? escape(answers_by(*field)) : "");
}

std::string mean_name(const AccuracyReport& report, const ScoreKind& kind) {
  return kind.id == "clean"
             ? fmt::format("mean over {} of {} fields", report.fields_above_noise(), report.fields.size())
             : "mean over fields";
}

std::string score_table(const AccuracyReport& report, const ScoreKind& kind) {
  std::string head = "<th>field</th>", body;
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    head += fmt::format("<th>{}</th>", escape(report.title(m)));
  if (kind.id == "nrmse" && report.best_peer())
    head += fmt::format("<th>gain over the best peer<br>[{:.0f} % interval]</th>", 100 * gain_level);
  head += "<th style=\"text-align:left\">ELROM answers by</th>";
  std::vector<double> means(report.methods.size(), 0.0);
  for (const auto& field : report.fields) {
    std::vector<double> values;
    for (std::size_t m = 0; m < report.methods.size(); ++m) {
      values.push_back(kind.value(report, field, m));
      means[m] += values.back() / static_cast<double>(report.fields.size());
    }
    body += score_row(field_label(field.info.name), values, kind, &field, notes(report, kind, &field));
  }
  if (kind.id == "clean")
    for (std::size_t m = 0; m < means.size(); ++m) means[m] = report.methods[m].mean_nrmse_without_noise;
  if (kind.has_mean)
    body += score_row(mean_name(report, kind), means, kind, nullptr, notes(report, kind, nullptr));
  return fmt::format(
      "<div data-score=\"{}\"{}><p class=\"lead\">{}</p><div "
      "class=\"scroll\"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div></div>",
      kind.id, kind.id == "nrmse" ? "" : " hidden", kind.note, head, body);
}

std::string tile(const std::string& label, const std::string& value, const std::string& note) {
  return fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>", label, value, note);
}

std::string interval_note(const Gain& gain) {
  return gain.interval ? fmt::format("{:.0f} % interval {:.1f} to {:.1f} %; ", 100 * gain_level,
                                     100 * gain.interval->low, 100 * gain.interval->high)
                       : "too few cases for an interval; ";
}

std::string optional_text(const std::optional<double>& value, double factor, const std::string& format_unit,
                          int decimals) {
  return value && std::isfinite(*value) ? fmt::format("{:.{}f}{}", *value * factor, decimals, format_unit)
                                        : "-";
}

struct AuditColumn {
  std::string title;
  std::function<std::string(const model::Audit&)> text;  ///< "-": not known
};

const std::vector<AuditColumn>& audit_columns() {
  static const std::vector<AuditColumn> columns{
      {"solids in the fields",
       [](const model::Audit& a) { return optional_text(a.solids_kg, 1e-3, " t", 1); }},
      {"of the inventory",
       [](const model::Audit& a) {
         std::optional<double> ratio;
         if (a.solids_kg && a.inventory_kg && *a.inventory_kg != 0) ratio = *a.solids_kg / *a.inventory_kg;
         return optional_text(ratio, 100, " %", 1);
       }},
      {"gas flow of the inlets'",
       [](const model::Audit& a) { return optional_text(a.gas_balance, 100, " %", 1); }},
      {"pressure drop", [](const model::Audit& a) { return optional_text(a.pressure_drop, 1, " Pa", 0); }},
      {"weight of solids", [](const model::Audit& a) { return optional_text(a.solids_weight, 1, " Pa", 0); }},
      {"cells out of bounds", [](const model::Audit& a) {
         std::size_t outside = 0;
         for (const auto& b : a.bounds) outside += b.n_outside + b.n_not_finite;
         return std::to_string(outside);
       }}};
  return columns;
}

std::string definition(std::string_view term, const std::string& text) {
  return text.empty() ? "" : fmt::format("<dt>{}</dt><dd>{}</dd>", term, text);
}

}  // namespace

std::string key_figures(const AccuracyReport& report) {
  const auto& own = report.methods.front();
  const auto best = report.best_peer();
  std::string tiles =
      tile("Mean NRMSE", score_text(own.mean_nrmse),
           fmt::format("over {} fields, {} held-out cases", report.fields.size(), report.cases.size()));
  if (best) {
    tiles += tile("Gain over the best peer", percent_text(report.gain().value),
                  fmt::format("{}{} reaches {}", interval_note(report.gain()),
                              escape(method_label(report.methods[*best].file.name)),
                              score_text(report.methods[*best].mean_nrmse)));
    tiles += tile("Fields no other method wins",
                  fmt::format("{} of {}", report.fields_won_against_all(), report.fields.size()),
                  fmt::format("against simple peers alone: {}", report.fields_won()));
  }
  if (report.has_averaged_truth())
    tiles +=
        tile("Gain, averaged truths", percent_text(report.averaged_gain().value),
             fmt::format("{}mean NRMSE {} against runs averaged, their noise taken off",
                         interval_note(report.averaged_gain()), score_text(report.averaged_error(0).value)));
  else if (std::isfinite(report.gain_without_noise()))
    tiles += tile("Gain, noise taken off", percent_text(report.gain_without_noise()),
                  fmt::format("mean NRMSE {}", score_text(own.mean_nrmse_without_noise)));
  if (const auto below = report.fields_below_noise(); below > 0)
    tiles += tile("Fields below the noise", fmt::format("{} of {}", below, report.fields.size()),
                  "the truth's measured noise exceeds ELROM's error");
  if (const double covered = report.mean_coverage(2); std::isfinite(covered))
    tiles += tile("Coverage at 90 %", percent_text(covered), "of held-out cells inside their interval");
  tiles += tile("One prediction", fmt::format("{:.1f} ms", own.predict_ms),
                fmt::format("all fields, after {:.1f} ms to open", own.open_ms));
  return "<dl class=\"keys\">" + tiles + "</dl>";
}

std::string score_tables(const AccuracyReport& report) {
  std::string buttons, tables;
  for (const auto& kind : score_kinds(report)) {
    buttons += fmt::format("<button type=\"button\" data-score-button=\"{}\" aria-pressed=\"{}\">{}</button>",
                           kind.id, kind.id == "nrmse", kind.title);
    tables += score_table(report, kind);
  }
  return "<div class=\"switch\">" + buttons + "</div>" + tables;
}

std::string choice_section(const AccuracyReport& report) {
  const auto chose = [](const FieldAccuracy& field) { return field.choice.candidates.size() > 1; };
  const auto first = std::ranges::find_if(report.fields, chose);
  if (first == report.fields.end()) return "";
  std::string head = "<th>field</th>", body;
  for (const auto& candidate : first->choice.candidates)
    head += fmt::format("<th>{}</th>", escape(method_label(candidate.name)));
  head += "<th>chosen</th><th>band by band</th><th>learned over</th>";
  for (const auto& field : report.fields) {
    if (!chose(field)) continue;
    std::string cells;
    for (const auto& candidate : field.choice.candidates)
      cells += fmt::format("<td class=\"mark{}\">{}{}</td>", candidate.weight > 0 ? " best" : "",
                           candidate.left_after > 0 ? "~" : "", score_text(candidate.nrmse));
    const auto& scale = field.choice.scale;
    body += fmt::format("<tr><th>{}</th>{}<td class=\"mark own\">{}</td><td>{}</td><td>{}</td></tr>",
                        escape(field_label(field.info.name)), cells, score_text(field.choice.nrmse),
                        score_text(field.choice.nrmse_by_band), scale.empty() ? "-" : escape(scale));
  }
  const auto lead = fmt::format(
      "NRMSE on training cases that the fit left out, in groups of neighbouring cases; held-out cases were "
      "not looked at. The dot marks what answers; ~ what left after some groups, which had shown that no blend "
      "could gain by it: the best one's error, times its own over the best one's in those groups. A blend is "
      "taken as far as it gains, wholly where it is "
      "{0:g} % better than its best member, and weights of each band of columns' own in the same way (-: all "
      "columns lie in one band). The last column says what the field's magnitude was found to grow as (-: "
      "nothing).",
      100 * methods::AutoOptions{}.full_gain);
  return section("choice", "What the choice went by", lead,
                 "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>" + body +
                     "</tbody></table></div>");
}

std::string worst_cell_table(const AccuracyReport& report) {
  std::string body;
  for (const auto& field : report.fields) {
    const auto& method = field.methods.front();
    const auto unit = shown_unit(field.info.name, field.info.unit);
    for (std::size_t i = 0; i < report.cases.size() && method.available; ++i) {
      const auto& worst = method.worst[i];
      body += fmt::format(
          "<tr><td>{}</td><td "
          "style=\"text-align:left\">{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</"
          "td></tr>",
          escape(field_label(field.info.name)), escape(report.cases[i].name), worst.position[0],
          worst.position[1], worst.position[2], value_text(worst.cell.truth * unit.factor, unit.symbol),
          value_text(worst.cell.prediction * unit.factor, unit.symbol));
    }
  }
  return "<details><summary>The worst cell of every field and case</summary><div "
         "class=\"scroll\"><table><thead><tr><th>field</th>"
         "<th style=\"text-align:left\">case</th><th>x [m]</th><th>y [m]</th><th>z [m]</th><th>" +
         escape(report.words.reference()) + "</th><th>predicted</th></tr></thead><tbody>" + body +
         "</tbody></table></div></details>";
}

std::string submodel_table(const AccuracyReport& report) {
  std::string body;
  for (const auto& field : report.fields)
    for (const auto& submodel : field.submodels)
      body += fmt::format(
          "<tr><td>{}</td><td style=\"text-align:left\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
          escape(field_label(field.info.name)), escape(submodel.name), submodel.n_cells,
          score_text(submodel.sums.standardised_mse()), score_text(submodel.sums.nrmse()));
  if (body.empty()) return "";
  return section(
      "submodels", "Submodels of the networks",
      "Columns are shared out to submodels by how hard they are to learn; the held-out error of each.",
      "<div class=\"scroll\"><table><thead><tr><th>field</th><th "
      "style=\"text-align:left\">band</th><th>cells</th><th>standardised MSE</th>"
      "<th>NRMSE</th></tr></thead><tbody>" +
          body + "</tbody></table></div>");
}

std::string validity_table(const AccuracyReport& report) {
  const bool with_loads = has_loads(report);
  std::string body;
  for (const auto& scored : report.cases) {
    const auto verdict = model::name_of(scored.validity.verdict);
    std::vector<std::string> nearest;
    for (const auto& near : scored.validity.nearest) nearest.push_back(case_text(near.name, near.load));
    body += fmt::format(
        "<tr><td>{}</td>{}<td style=\"text-align:left\"><span class=\"verdict "
        "{}\">{}</span></td><td>{:.2f}</td><td class=\"text\">{}</td><td class=\"text\">{}</td></tr>",
        escape(scored.name), with_loads ? "<td>" + percent_text(scored.load, 0) + "</td>" : "", verdict,
        verdict, scored.validity.p_value, escape(scored.validity.reason), escape(base::join(nearest, ", ")));
  }
  return fmt::format(
      "<div class=\"scroll\"><table><thead><tr><th>case</th>{}<th "
      "style=\"text-align:left\">verdict</th><th>p-value</th><th style=\"text-align:left\">"
      "reason</th><th style=\"text-align:left\">nearest training cases</th></tr></thead><tbody>{}</tbody>"
      "</table></div>",
      with_loads ? "<th>load</th>" : "", body);
}

std::string audit_table(const AccuracyReport& report) {
  // A quantity that no case has, as solids in a flow without any, is no column.
  std::vector<const AuditColumn*> shown;
  for (const auto& column : audit_columns())
    if (std::ranges::any_of(report.cases, [&](const ScoredCase& one) {
          return column.text(one.truth_audit) != "-" || column.text(one.prediction_audit) != "-";
        }))
      shown.push_back(&column);
  std::string head = "<th>case</th>", body;
  for (const auto* column : shown) head += "<th>" + column->title + "</th>";
  const auto row = [&](const std::string& name, const std::string& whose, const model::Audit& audit) {
    body += "<tr><td>" + escape(name) + " <small>" + escape(whose) + "</small></td>";
    for (const auto* column : shown) body += "<td>" + column->text(audit) + "</td>";
    body += "</tr>";
  };
  for (const auto& scored : report.cases) {
    row(scored.name, report.words.reference(), scored.truth_audit);
    row(scored.name, "predicted", scored.prediction_audit);
  }
  return "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead><tbody>" + body +
         "</tbody></table></div>";
}

std::string provenance(const AccuracyReport& report) {
  std::string stages;
  for (const auto& [stage, seconds] : report.study.stage_seconds)
    stages += fmt::format("{}{}: {}", stages.empty() ? "" : "; ", escape(stage), base::duration(seconds));
  const auto truth = escape(report.words.reference());
  const auto terms =
      definition("NRMSE",
                 fmt::format("&radic;(&Sigma;(prediction &minus; {0})&sup2; / &Sigma;(training mean &minus; "
                             "{0})&sup2;), summed over cells and over all held-out cases; cells count alike.",
                             truth)) +
      definition(
          "Standardised MSE",
          fmt::format("mean of ((prediction &minus; {}) / &sigma; of the column over training cases and "
                      "planes)&sup2;.",
                      truth)) +
      definition("R&sup2;",
                 fmt::format("1 &minus; &Sigma;(prediction &minus; {0})&sup2; / &Sigma;({0} &minus; its "
                             "mean)&sup2; over all cells of all held-out cases.",
                             truth)) +
      definition(
          "Gain",
          fmt::format("1 &minus; NRMSE of ELROM / NRMSE of the best simple peer; its {:.0f} % interval by "
                      "bootstrap over the held-out cases ({} draws), widened for few cases.",
                      100 * gain_level, math::BootstrapOptions{}.n_draws)) +
      definition("Noise", report.repeats.empty()
                              ? "not known: no repeated runs among the held-out cases."
                              : "variance between runs of the same boundary conditions (" +
                                    escape(base::join(report.repeats, ", ")) + "), averaged over the sets.") +
      definition("Simple peers",
                 "nearest case, linear, POD with radial basis functions, POD with Gaussian processes, as a "
                 "user would run them: without mirror images.") +
      definition("Store", escape(report.study.store.filename().string())) +
      definition("Bundle", escape(report.methods.front().digest)) +
      definition("Program", escape(program_version())) + definition("Training", stages);
  return section("about", "Definitions and provenance", "",
                 "<dl class=\"defs\">" + terms + "</dl>" + worst_cell_table(report));
}

}  // namespace elrom::report
