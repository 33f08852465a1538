#include "elrom/report/page.hpp"

#include <fmt/format.h>

#include "elrom/base/error.hpp"
#include "elrom/base/version.hpp"
#include "names.hpp"
#include "page_assets.hpp"
#include "page_parts.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using svg::escape;

std::string navigation(const AccuracyReport& report, bool with_choice, const PageExtras& extras) {
  std::string links =
      "<a href=\"#table\">Scores</a><a href=\"#cuts\">Cuts</a><a href=\"#profiles\">Profiles</a><a "
      "href=\"#loads\">" +
      std::string(has_loads(report) ? "Loads" : "Cases") +
      "</a>"
      "<a href=\"#budget\">Error budget</a><a href=\"#coverage\">Coverage</a><a href=\"#errors\">Errors</a>"
      "<a href=\"#validity\">Validity</a>";
  if (with_choice) links += "<a href=\"#choice\">Choice</a>";
  if (extras.learning_curve) links += "<a href=\"#learning\">More cases</a>";
  if (extras.cost) links += "<a href=\"#cost\">Cost</a>";
  if (!extras.searches.empty()) links += "<a href=\"#search\">Search</a>";
  return links;
}

std::string opening(const AccuracyReport& report) {
  return fmt::format(
      "<header><p class=\"over\">Accuracy of study <b>{}</b> on cases it never saw &middot; {} planes "
      "&times; {} columns &middot; {} "
      "training cases &middot; {}</p><h1>{}</h1>{}</header>",
      escape(report.study.name), report.n_planes, report.n_columns, report.n_training, escape(report.created),
      escape(headline(report)), key_figures(report));
}

std::string validity_section(const AccuracyReport& report) {
  return section(
      "validity", "Validity and physics of the held-out cases",
      "Where each case lies among the training cases, and what the fields say about mass and pressure. "
      "Averages of the cases themselves need not close their balances exactly either: compare the two rows.",
      validity_table(report) + "<h3 style=\"margin-top:22px\">Physics audit</h3>" + audit_table(report));
}

}  // namespace

std::string section(std::string_view id, std::string_view title, std::string_view lead,
                    std::string_view body) {
  return fmt::format("<section id=\"{}\"><h2>{}</h2><p class=\"lead\">{}</p>{}</section>", id, title, lead,
                     body);
}

std::string figure(const std::string& caption, const std::string& drawing) {
  return fmt::format("<figure><figcaption>{}</figcaption>{}</figure>", escape(caption), drawing);
}

std::string whole_page(const std::string& title, const std::string& links, const std::string& content) {
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\"><meta name=\"generator\" content=\"{}\"><title>{}</title><style>",
      escape(program_version()), escape(title));
  page += page_style();
  page += fmt::format(
      "</style></head><body><nav><div class=\"bar\"><b>ELROM</b>{}<button id=\"theme\" type=\"button\">Light / "
      "dark</button></div></nav><main>{}</main><script>",
      links, content);
  page += page_script();
  return page + "</script></body></html>\n";
}

std::string html_page(const AccuracyReport& report, const PageExtras& extras) {
  check(report.figures.has_value(), "html_page: the report was made without figures");
  const auto choice = choice_section(report);
  std::string content =
      opening(report) +
      section("table", "Scores by field",
              "Every method on the same cases and the same cells. The dot marks the best in each row.",
              score_tables(report));
  content += cut_section(report) + profile_section(report) + load_section(report) + budget_section(report);
  content += coverage_section(report) + error_section(report) + submodel_table(report) +
             validity_section(report) + choice;
  if (extras.learning_curve) content += learning_section(*extras.learning_curve);
  if (extras.cost) content += cost_section(*extras.cost);
  if (!extras.searches.empty()) content += search_section(extras.searches);
  content += provenance(report);
  content +=
      fmt::format("<footer>{} &middot; {}</footer>", escape(program_version()), escape(report.created));
  return whole_page("ELROM accuracy: " + report.study.name, navigation(report, !choice.empty(), extras),
                    content);
}

PageExtras find_extras(const StudyFiles& study) {
  PageExtras extras;
  auto curve = study.directory / "learning-curve.json";
  if (!std::filesystem::exists(curve)) curve = study.directory / "learning-curve-small.json";
  const auto cost = study.directory / "cost.json", trials = study.directory / "search.sqlite";
  if (std::filesystem::exists(curve)) extras.learning_curve = read_learning_curve(curve);
  if (std::filesystem::exists(cost)) extras.cost = read_cost_report(cost);
  if (std::filesystem::exists(trials)) extras.searches = networks::TrialStore(trials).searches();
  return extras;
}

}  // namespace elrom::report
