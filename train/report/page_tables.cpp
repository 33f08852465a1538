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
    kinds.push_back({"clean", "Noise taken off",
                     "NRMSE after the noise of the truth, measured by repeated runs, is taken off error and "
                     "reference alike.",
                     false, true, [](const AccuracyReport&, const FieldAccuracy& field, std::size_t m) {
                       return field.nrmse_without_noise(m);
                     }});
  kinds.push_back(
      {"mse", "Standardised MSE",
       "The source's figure: mean squared error in units of each column's variance over the training set.",
       false, true, pooled(&ErrorSums::standardised_mse)});
  kinds.push_back({"rmse", "RMSE", "In the field's own unit.", false, false, pooled(&ErrorSums::rmse)});
  kinds.push_back({"r2", "R²",
                   "Of all cells of all held-out cases about their one mean: high wherever the furnace's own "
                   "structure is captured.",
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

std::string score_row(const std::string& name, const std::vector<double>& values, const ScoreKind& kind,
                      const FieldAccuracy* field, bool is_sum) {
  const auto best = best_of(values, kind.higher_is_better);
  const auto unit = field != nullptr ? shown_unit(field->info.name, field->info.unit) : ShownUnit{};
  std::string cells;
  for (std::size_t m = 0; m < values.size(); ++m) {
    const auto text = kind.id != "rmse"          ? score_text(values[m])
                      : std::isfinite(values[m]) ? value_text(values[m] * unit.factor, unit.symbol)
                                                 : "-";
    cells +=
        fmt::format("<td class=\"mark{}{}\">{}</td>", m == 0 ? " own" : "", m == best ? " best" : "", text);
  }
  const auto by = field == nullptr                   ? std::string()
                  : field->methods[0].detail.empty() ? method_label(field->methods[0].kind)
                                                     : "blend: " + field->methods[0].detail;
  return fmt::format("<tr{}><th>{}</th>{}<td class=\"text\">{}</td></tr>", is_sum ? " class=\"sum\"" : "",
                     escape(name), cells, escape(by));
}

std::string score_table(const AccuracyReport& report, const ScoreKind& kind) {
  std::string head = "<th>field</th>", body;
  for (const auto& method : report.methods)
    head += fmt::format("<th>{}</th>", escape(method_label(method.file.name)));
  head += "<th style=\"text-align:left\">ELROM answers by</th>";
  std::vector<double> sums(report.methods.size(), 0.0);
  for (const auto& field : report.fields) {
    std::vector<double> values;
    for (std::size_t m = 0; m < report.methods.size(); ++m) {
      values.push_back(kind.value(report, field, m));
      sums[m] += values.back() / static_cast<double>(report.fields.size());
    }
    body += score_row(field_label(field.info.name), values, kind, &field, false);
  }
  if (kind.has_mean) body += score_row("mean over fields", sums, kind, nullptr, true);
  return fmt::format(
      "<div data-score=\"{}\"{}><p class=\"lead\">{}</p><div "
      "class=\"scroll\"><table><thead><tr>{}</tr></thead><tbody>{}</tbody></table></div></div>",
      kind.id, kind.id == "nrmse" ? "" : " hidden", kind.note, head, body);
}

std::string tile(const std::string& label, const std::string& value, const std::string& note) {
  return fmt::format("<div><dt>{}</dt><dd>{}<small>{}</small></dd></div>", label, value, note);
}

std::string optional_text(const std::optional<double>& value, double factor, const std::string& format_unit,
                          int decimals) {
  return value && std::isfinite(*value) ? fmt::format("{:.{}f}{}", *value * factor, decimals, format_unit)
                                        : "-";
}

std::string audit_row(const std::string& name, const model::Audit& a) {
  std::optional<double> ratio;
  if (a.solids_kg && a.inventory_kg && *a.inventory_kg != 0) ratio = *a.solids_kg / *a.inventory_kg;
  std::size_t outside = 0;
  for (const auto& b : a.bounds) outside += b.n_outside + b.n_not_finite;
  return fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                     name, optional_text(a.solids_kg, 1e-3, " t", 1), optional_text(ratio, 100, " %", 1),
                     optional_text(a.gas_balance, 100, " %", 1), optional_text(a.pressure_drop, 1, " Pa", 0),
                     optional_text(a.solids_weight, 1, " Pa", 0), outside);
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
    tiles += tile("Gain over the best peer", percent_text(report.gain()),
                  fmt::format("{} reaches {}", escape(method_label(report.methods[*best].file.name)),
                              score_text(report.methods[*best].mean_nrmse)));
    tiles += tile("Fields no peer wins", fmt::format("{} of {}", report.fields_won(), report.fields.size()),
                  "against every simple peer");
  }
  if (std::isfinite(report.gain_without_noise()))
    tiles += tile("Gain, noise taken off", percent_text(report.gain_without_noise()),
                  fmt::format("mean NRMSE {}", score_text(own.mean_nrmse_without_noise)));
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
  head += "<th>chosen</th><th>band by band</th>";
  for (const auto& field : report.fields) {
    if (!chose(field)) continue;
    std::string cells;
    for (const auto& candidate : field.choice.candidates)
      cells += fmt::format("<td class=\"mark{}\">{}</td>", candidate.weight > 0 ? " best" : "",
                           score_text(candidate.nrmse));
    body += fmt::format("<tr><th>{}</th>{}<td class=\"mark own\">{}</td><td>{}</td></tr>",
                        escape(field_label(field.info.name)), cells, score_text(field.choice.nrmse),
                        score_text(field.choice.nrmse_by_band));
  }
  const auto lead = fmt::format(
      "NRMSE on training cases that the fit left out, in groups of neighbouring loads; held-out cases were "
      "not "
      "looked at. The dot marks what answers. A blend is taken where it is {0:g} % better than its best "
      "member, "
      "and weights of each band of columns' own (last column) where they are {0:g} % better still (-: all "
      "columns "
      "lie in one band).",
      100 * methods::AutoOptions{}.least_gain);
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
         "<th style=\"text-align:left\">case</th><th>x [m]</th><th>y [m]</th><th>z "
         "[m]</th><th>EL3D</th><th>predicted</th></tr></thead><tbody>" +
         body + "</tbody></table></div></details>";
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
  std::string body;
  for (const auto& scored : report.cases) {
    const auto verdict = model::name_of(scored.validity.verdict);
    std::string nearest;
    for (const auto& near : scored.validity.nearest)
      nearest += fmt::format("{}{} ({:.0f} % load)", nearest.empty() ? "" : ", ", escape(near.name),
                             100 * near.load);
    body += fmt::format(
        "<tr><td>{}</td><td>{:.0f} %</td><td style=\"text-align:left\"><span class=\"verdict "
        "{}\">{}</span></td><td>{:.2f}</td><td class=\"text\">{}</td><td class=\"text\">{}</td></tr>",
        escape(scored.name), 100 * scored.load, verdict, verdict, scored.validity.p_value,
        escape(scored.validity.reason), nearest);
  }
  return "<div class=\"scroll\"><table><thead><tr><th>case</th><th>load</th><th "
         "style=\"text-align:left\">verdict</th><th>p-value</th><th style=\"text-align:left\">"
         "reason</th><th style=\"text-align:left\">nearest training cases</th></tr></thead><tbody>" +
         body + "</tbody></table></div>";
}

std::string audit_table(const AccuracyReport& report) {
  std::string body;
  for (const auto& scored : report.cases)
    body += audit_row(escape(scored.name) + " <small>EL3D</small>", scored.truth_audit) +
            audit_row(escape(scored.name) + " <small>predicted</small>", scored.prediction_audit);
  return "<div class=\"scroll\"><table><thead><tr><th>case</th><th>solids in the fields</th><th>of the "
         "inventory</th><th>gas flow of the inlets'</th><th>pressure drop</th>"
         "<th>weight of solids</th><th>cells out of bounds</th></tr></thead><tbody>" +
         body + "</tbody></table></div>";
}

std::string provenance(const AccuracyReport& report) {
  std::string stages;
  for (const auto& [stage, seconds] : report.study.stage_seconds)
    stages += fmt::format("{}{}: {}", stages.empty() ? "" : "; ", escape(stage), base::duration(seconds));
  const auto terms =
      definition("NRMSE",
                 "&radic;(&Sigma;(prediction &minus; EL3D)&sup2; / &Sigma;(training mean &minus; "
                 "EL3D)&sup2;), summed over cells and over all held-out cases; cells count alike.") +
      definition("Standardised MSE",
                 "mean of ((prediction &minus; EL3D) / &sigma; of the column over training cases and "
                 "planes)&sup2;.") +
      definition("R&sup2;",
                 "1 &minus; &Sigma;(prediction &minus; EL3D)&sup2; / &Sigma;(EL3D &minus; its mean)&sup2; "
                 "over all cells of all held-out cases.") +
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
