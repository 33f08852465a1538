// The page of a comparison: verdicts by field, errors by case, cuts of the truth, of A, of B and of what
// differs.

#include <fmt/format.h>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/report/compare.hpp"
#include "names.hpp"
#include "page_parts.hpp"

namespace elrom::report {
namespace {

using svg::escape;

std::string bundle_text(const Comparison& comparison, std::size_t m) {
  return fmt::format("<dt>{}</dt><dd>{}, {} training cases, {}</dd>", m == 0 ? "A" : "B",
                     escape((m == 0 ? comparison.a : comparison.b).string()),
                     comparison.report.methods[m].training_cases.size(),
                     escape(comparison.report.methods[m].digest));
}

std::string verdict_row(const std::string& name, const FieldComparison& one, bool is_mean) {
  const auto verdict = one.gain.verdict();
  const auto colour = verdict == Gain::Verdict::better  ? "inside"
                      : verdict == Gain::Verdict::worse ? "outside"
                                                        : "";
  return fmt::format(
      "<tr{}><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td style=\"text-align:left\"><span class=\"verdict "
      "{}\">{}</span></td></tr>",
      is_mean ? " class=\"sum\"" : "", escape(name), score_text(one.a), score_text(one.b),
      gain_text(one.gain), colour, verdict_text(one.gain));
}

std::string verdict_section(const Comparison& comparison) {
  std::string body;
  for (const auto& field : comparison.fields) body += verdict_row(field_label(field.field), field, false);
  body += verdict_row("mean over fields", comparison.mean, true);
  const auto lead = fmt::format(
      "NRMSE pooled over the cases (1: predicting the mean of A's training cases), and by how much B's is below A's, with the {:.0f} % interval over the cases "
      "(bootstrap, both on the same draws). Better and worse where the interval leaves out zero.",
      100 * gain_level);
  return section(
      "table", "Verdict by field", lead,
      "<div class=\"scroll\"><table><thead><tr><th>field</th><th>A</th><th>B</th><th>B's gain</th><th "
      "style=\"text-align:left\">B is</th></tr></thead><tbody>" +
          body + "</tbody></table></div>");
}

std::string case_section(const Comparison& comparison) {
  const auto& report = comparison.report;
  std::string head = "<th>field</th>", body;
  for (const auto& scored : report.cases)
    head += "<th>" + escape(case_text(scored.name, scored.load)) + "</th>";
  for (const auto& field : report.fields) {
    body += "<tr><th>" + escape(field_label(field.info.name)) + "</th>";
    for (std::size_t i = 0; i < report.cases.size(); ++i)
      body += fmt::format("<td>{} &rarr; {}</td>", score_text(field.methods[0].cases[i].nrmse()),
                          score_text(field.methods[1].cases[i].nrmse()));
    body += "</tr>";
  }
  return section("cases", "By case", "NRMSE of A &rarr; B, each case against its own distance from the mean.",
                 "<div class=\"scroll\"><table class=\"tight\"><thead><tr>" + head + "</tr></thead><tbody>" +
                     body + "</tbody></table></div>");
}

std::string picture_section(const AccuracyReport& report) {
  const auto truth = escape(report.words.reference());
  if (report.figures->cut_methods.size() < 2)
    return section("cuts", "Vertical cuts", "Too many cases to draw them all: name a few with --cases.", "");
  return section(
      "cuts", fmt::format("Vertical cuts: {}, A, B and their differences", truth),
      "Through the middle of the mesh, to scale. The first row shares one colour scale, the second "
      "another.",
      cut_viewer(report,
                 {{truth, "0"},
                  {"A", "1"},
                  {"B", "2"},
                  {"A &minus; " + truth, "1-0"},
                  {"B &minus; " + truth, "2-0"},
                  {"B &minus; A", "2-1"}},
                 false));
}

std::string about_section(const Comparison& comparison) {
  auto terms = bundle_text(comparison, 0) + bundle_text(comparison, 1) + "<dt>Store</dt><dd>" +
               escape(comparison.report.study.store.filename().string()) + "</dd>";
  if (!comparison.left_out.empty())
    terms +=
        "<dt>Left out</dt><dd>A or B was trained on them: " + escape(base::join(comparison.left_out, ", ")) +
        "</dd>";
  if (!comparison.missing.empty())
    terms += "<dt>Only in A</dt><dd>" + escape(base::join(comparison.missing, ", ")) + "</dd>";
  return section("about", "What was compared", "", "<dl class=\"defs\">" + terms + "</dl>");
}

}  // namespace

std::string html_page(const Comparison& comparison) {
  const auto& report = comparison.report;
  check(report.figures.has_value(), "html_page: the comparison was made without figures");
  const auto opening = fmt::format(
      "<header><p class=\"over\">A: <b>{}</b> &middot; B: <b>{}</b> &middot; {}</p><h1>{}</h1></header>",
      escape(comparison.a.string()), escape(comparison.b.string()), escape(report.created),
      escape(headline(comparison)));
  return whole_page("ELROM comparison",
                    "<a href=\"#table\">Verdict</a><a href=\"#cuts\">Cuts</a><a href=\"#cases\">Cases</a><a "
                    "href=\"#about\">About</a>",
                    opening + verdict_section(comparison) + picture_section(report) +
                        case_section(comparison) + about_section(comparison) +
                        fmt::format("<footer>{}</footer>", escape(program_version())));
}

}  // namespace elrom::report
