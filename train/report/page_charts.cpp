// Drawn sections of the page: cases, error budget, coverage, error distributions, profiles.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "elrom/methods/catalogue.hpp"
#include "names.hpp"
#include "page_parts.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using svg::escape;

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit == "1" || unit.empty() ? name : name + " [" + unit + "]";
}

// Cases by rising load, for lines; those that state none come last, by name.
std::vector<std::size_t> by_load(const AccuracyReport& report) {
  const auto place = [](const ScoredCase& one) {
    return std::pair(std::isfinite(one.load) ? one.load : std::numeric_limits<double>::infinity(), one.name);
  };
  std::vector<std::size_t> order(report.cases.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return place(report.cases[a]) < place(report.cases[b]); });
  return order;
}

double mean_case_nrmse(const AccuracyReport& report, std::size_t method, std::size_t i_case) {
  double sum = 0;
  for (const auto& field : report.fields) {
    if (!field.methods[method].available) return std::nan("");
    sum += field.methods[method].cases[i_case].nrmse();
  }
  return sum / static_cast<double>(report.fields.size());
}

std::string load_chart(const AccuracyReport& report) {
  std::vector<double> loads, everything;
  std::vector<std::vector<double>> errors(report.methods.size());
  for (const auto i : by_load(report)) {
    if (!std::isfinite(report.cases[i].load)) continue;
    loads.push_back(100 * report.cases[i].load);
    for (std::size_t m = 0; m < report.methods.size(); ++m)
      errors[m].push_back(mean_case_nrmse(report, m, i));
  }
  for (const auto& list : errors) everything.insert(everything.end(), list.begin(), list.end());
  everything.push_back(0);
  svg::Chart chart({.width = 640, .height = 340}, svg::fit_axis("load [% of full load]", loads),
                   svg::fit_axis("mean NRMSE over fields", everything), "Error against load");
  for (std::size_t m = report.methods.size(); m-- > 0;) {
    const auto name = method_label(report.methods[m].file.name);
    chart.line(loads, errors[m], series_class(report, m), name);
    chart.points(loads, errors[m], series_class(report, m), name);
  }
  return chart.text() + method_legend(report, false);
}

std::string load_table(const AccuracyReport& report) {
  std::string head = "<th>field</th>", body;
  for (const auto i : by_load(report))
    head += "<th>" + escape(report.cases[i].name) +
            (has_loads(report) ? fmt::format("<br>{}", percent_text(report.cases[i].load, 0)) : "") + "</th>";
  for (const auto& field : report.fields) {
    body += fmt::format("<tr><th>{}</th>", escape(field_label(field.info.name)));
    for (const auto i : by_load(report))
      body += fmt::format("<td>{}</td>", score_text(field.methods[0].cases[i].nrmse()));
    body += "</tr>";
  }
  return "<div class=\"scroll\"><table class=\"tight\"><thead><tr>" + head + "</tr></thead><tbody>" + body +
         "</tbody></table></div>";
}

std::string coverage_chart(const AccuracyReport& report) {
  svg::Chart chart({.width = 440, .height = 380}, {"promised [%]", 40, 100}, {"measured [%]", 40, 100},
                   "Promised against measured coverage");
  const std::vector<double> ends{40, 100};
  chart.line(ends, ends, "rule", "measured = promised");
  std::vector<double> levels, means;
  for (std::size_t k = 0; k < coverage_levels.size(); ++k) {
    levels.push_back(100 * coverage_levels[k]);
    means.push_back(100 * report.mean_coverage(k));
  }
  for (const auto& field : report.fields) {
    std::vector<double> measured;
    for (const auto& by_case : field.coverage) {
      double sum = 0;
      for (const double share : by_case) sum += share;
      measured.push_back(100 * sum / static_cast<double>(by_case.size()));
    }
    if (measured.size() == levels.size())
      chart.line(levels, measured, "s1 thin", field_label(field.info.name));
  }
  chart.line(levels, means, "s0", "all fields");
  chart.points(levels, means, "s0", "all fields");
  return chart.text() +
         "<ul class=\"legend\"><li><i class=\"s0\"></i>all fields</li><li><i class=\"s1\"></i>one "
         "field</li></ul>";
}

std::string coverage_table(const AccuracyReport& report) {
  std::string head = "<th>field, at 90 %</th>", body;
  for (const auto i : by_load(report)) head += fmt::format("<th>{}</th>", escape(report.cases[i].name));
  head += "<th>all</th>";
  constexpr std::size_t at_90 = 2;
  for (const auto& field : report.fields) {
    if (field.coverage.size() <= at_90) continue;
    body += fmt::format("<tr><th>{}</th>", escape(field_label(field.info.name)));
    double sum = 0;
    for (const auto i : by_load(report)) {
      sum += field.coverage[at_90][i] / static_cast<double>(report.cases.size());
      body += fmt::format("<td>{}</td>", percent_text(field.coverage[at_90][i]));
    }
    body += fmt::format("<td class=\"own\">{}</td></tr>", percent_text(sum));
  }
  return "<div class=\"scroll\"><table class=\"tight\"><thead><tr>" + head + "</tr></thead><tbody>" + body +
         "</tbody></table></div>";
}

std::string parity_chart(const AccuracyReport& report, const FieldAccuracy& field, const ParityMap& map) {
  const auto unit = shown_unit(field.info.name, field.info.unit);
  const svg::Axis x{with_unit(report.words.reference(), unit.symbol), map.low * unit.factor,
                    map.high * unit.factor};
  const svg::Axis y{with_unit("predicted", unit.symbol), x.low, x.high};
  return parity_drawing(map, x, y, "s0", "Parity of " + field.info.name);
}

// A histogram as a step line: share of cells per bin, in per cent.
void step_line(svg::Chart& chart, const Histogram& histogram, double factor, const std::string& css_class,
               const std::string& name) {
  std::vector<double> x, y;
  const double step = (histogram.high - histogram.low) / static_cast<double>(histogram.counts.size());
  const auto total = static_cast<double>(std::max<std::uint64_t>(1, histogram.total()));
  for (std::size_t i = 0; i < histogram.counts.size(); ++i)
    for (const std::size_t edge : {i, i + 1}) {
      x.push_back(factor * (histogram.low + step * static_cast<double>(edge)));
      y.push_back(100 * static_cast<double>(histogram.counts[i]) / total);
    }
  chart.line(x, y, css_class, name);
}

std::string error_chart(const AccuracyReport& report, const FieldAccuracy& field,
                        const FieldFigures& figures) {
  const auto unit = shown_unit(field.info.name, field.info.unit);
  double most = 0;
  const auto best = report.best_peer(field);
  const auto shown = best ? std::vector<std::size_t>{0, *best} : std::vector<std::size_t>{0};
  for (const auto m : shown)
    for (const auto count : figures.errors[m].counts)
      most = std::max(most, 100 * static_cast<double>(count) /
                                static_cast<double>(std::max<std::uint64_t>(1, figures.errors[m].total())));
  const auto& own = figures.errors.front();
  svg::Chart chart({.width = 320, .height = 220, .left = 50},
                   {with_unit("predicted - " + report.words.reference(), unit.symbol), own.low * unit.factor,
                    own.high * unit.factor},
                   {"cells [%]", 0, most > 0 ? 1.08 * most : 1}, "Errors of " + field.info.name);
  for (auto m = shown.rbegin(); m != shown.rend(); ++m)
    step_line(chart, figures.errors[*m], unit.factor, series_class(report, *m),
              method_label(report.methods[*m].file.name));
  return chart.text();
}

std::string profile_chart(const AccuracyReport& report, std::size_t f, std::size_t i_case) {
  const auto& field = report.fields[f];
  const auto& drawn = report.figures->fields[f];
  const auto unit = shown_unit(field.info.name, field.info.unit);
  const auto scaled = [&](std::vector<double> values) {
    for (auto& value : values) value *= unit.factor;
    return values;
  };
  std::vector<std::vector<double>> series;
  std::vector<double> everything;
  for (const auto& profile : drawn.profiles[i_case]) series.push_back(scaled(profile));
  for (std::size_t k = 0; k < std::min<std::size_t>(2, series.size()); ++k)
    everything.insert(everything.end(), series[k].begin(), series[k].end());
  const auto quantity = with_unit(field_label(field.info.name), unit.symbol);
  const auto of_truth = svg::fit_axis(quantity, series[0], 2.2);
  const auto x = of_truth.scale == svg::Scale::log ? of_truth : svg::fit_axis(quantity, everything);
  const auto& z = report.figures->heights;
  svg::Chart chart({.width = 330, .height = 300, .left = 44, .clip = true}, x,
                   {"z [m]", 0, z.back() + z.front()}, "Profile of " + field.info.name);
  if (!drawn.half_width.empty()) {
    std::vector<double> low, high;
    for (std::size_t p = 0; p < z.size(); ++p) {
      low.push_back(series[1][p] - unit.factor * drawn.half_width[i_case][p]);
      high.push_back(series[1][p] + unit.factor * drawn.half_width[i_case][p]);
    }
    chart.band(low, high, z, "s0", "90 % interval of a cell, mean over the plane");
  }
  for (std::size_t m = report.methods.size(); m-- > 1;)
    if (!series[m + 1].empty())
      chart.line(series[m + 1], z, series_class(report, m) + " thin",
                 method_label(report.methods[m].file.name));
  chart.line(series[0], z, "truth", report.words.reference());
  chart.line(series[1], z, series_class(report, 0), "ELROM");
  return chart.text();
}

}  // namespace

std::string parity_drawing(const ParityMap& map, const svg::Axis& x, const svg::Axis& y,
                           const std::string& css_class, const std::string& title) {
  svg::Chart chart({.width = 320, .height = 300, .left = 62}, x, y, title);
  const double most = static_cast<double>(*std::max_element(map.counts.begin(), map.counts.end()));
  const double step = (x.high - x.low) / static_cast<double>(map.n_bins);
  for (std::size_t i = 0; i < map.n_bins; ++i)
    for (std::size_t j = 0; j < map.n_bins; ++j) {
      const auto count = map.counts[i * map.n_bins + j];
      if (count == 0) continue;
      const double shade = 0.12 + 0.88 * std::log1p(static_cast<double>(count)) / std::log1p(most);
      const double left = x.low + step * static_cast<double>(i), low = x.low + step * static_cast<double>(j);
      chart.box(left, left + step, low, low + step, css_class, "", shade);
    }
  const std::vector<double> ends{x.low, x.high};
  chart.line(ends, ends, "rule", "equal");
  return chart.text();
}

std::string series_class(const AccuracyReport& report, std::size_t method) {
  if (method == 0) return "s0";
  const auto* known = methods::find_method(report.methods[method].file.name);
  return fmt::format("s{}", known != nullptr ? known->place : static_cast<int>(8 + method % 2));
}

std::string method_legend(const AccuracyReport& report, bool with_truth) {
  std::string items =
      with_truth ? "<li><i class=\"truth\"></i>" + escape(report.words.reference()) + "</li>" : "";
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    items += fmt::format("<li><i class=\"{}\"></i>{}</li>", series_class(report, m), escape(report.title(m)));
  return "<ul class=\"legend\">" + items + "</ul>";
}

std::string load_section(const AccuracyReport& report) {
  const bool with_loads = has_loads(report);
  return section("loads", with_loads ? "Error against load" : "Error by case",
                 "Each held-out case on its own. NRMSE of one case is taken against that case's own distance "
                 "from the training mean.",
                 "<div class=\"grid2\">" +
                     (with_loads ? figure("Mean over fields, by method", load_chart(report)) : "") +
                     "<figure><figcaption>ELROM, by field</figcaption>" + load_table(report) +
                     "</figure></div>");
}

std::string budget_section(const AccuracyReport& report) {
  std::vector<svg::BarRow> rows;
  for (const auto& field : report.fields) {
    const auto& b = field.budget;
    rows.push_back({field_label(field.info.name),
                    {{b.noise, "noise", fmt::format("noise of the truth {:.3f}", b.noise)},
                     {b.compression, "compression", fmt::format("compression {:.3f}", b.compression)},
                     {b.regression, "regression", fmt::format("regression {:.3f}", b.regression)}},
                    fmt::format("{:.3f}", b.nrmse_squared())});
  }
  const std::string legend =
      "<ul class=\"legend\"><li><i class=\"block noise\" style=\"background:var(--noise)\"></i>noise of the "
      "truth: longer averaging lowers it</li>"
      "<li><i class=\"block\" style=\"background:var(--compression)\"></i>compression: outside every "
      "combination of the training cases; more cases lower it</li>"
      "<li><i class=\"block\" style=\"background:var(--regression)\"></i>regression: the model's "
      "own</li></ul>";
  return section(
      "budget", "Where the error comes from",
      report.repeats.empty() ? "Parts of NRMSE&sup2;. Without repeated runs the noise of the truth is not "
                               "known; it is inside the other two."
                             : "Parts of NRMSE&sup2;. The noise of the truth is measured by repeated runs of "
                               "the same boundary conditions; about the least that any model can reach.",
      svg::bars(rows, "share of the departure from the training mean (NRMSE squared)", "Error budget", 860) +
          legend);
}

std::string coverage_section(const AccuracyReport& report) {
  if (!std::isfinite(report.mean_coverage(2)))
    return section("coverage", "Promised and measured coverage",
                   "The bundle makes no promise: it holds no uncertainty.", "");
  return section("coverage", "Promised and measured coverage",
                 "Share of held-out cells that lie inside their prediction interval. Cells of one case err "
                 "together, so a single case may well lie off the line.",
                 "<div class=\"grid2\">" + figure("All held-out cases", coverage_chart(report)) +
                     "<figure><figcaption>By field and case</figcaption>" + coverage_table(report) +
                     "</figure></div>");
}

std::string error_section(const AccuracyReport& report) {
  std::string figures;
  for (std::size_t f = 0; f < report.fields.size(); ++f)
    figures += fmt::format("<figure><figcaption>{}</figcaption>{}{}</figure>",
                           escape(field_label(report.fields[f].info.name)),
                           parity_chart(report, report.fields[f], report.figures->fields[f].parity),
                           error_chart(report, report.fields[f], report.figures->fields[f]));
  return section("errors", "Parity and distribution of errors",
                 "All cells of all held-out cases: prediction against " + escape(report.words.reference()) +
                     " (darker: more cells, on a logarithmic scale), and the errors of ELROM beside the "
                     "field's best simple peer.",
                 method_legend(report, false) + "<div class=\"grid3\">" + figures + "</div>");
}

std::string profile_section(const AccuracyReport& report) {
  std::string options, groups;
  for (std::size_t i = 0; i < report.cases.size(); ++i) {
    options += fmt::format("<option value=\"{}\">{}</option>", i,
                           escape(case_text(report.cases[i].name, report.cases[i].load)));
    std::string figures;
    for (std::size_t f = 0; f < report.fields.size(); ++f)
      figures += figure(field_label(report.fields[f].info.name), profile_chart(report, f, i));
    groups += fmt::format("<div class=\"grid3\" data-profile-case=\"{}\"{}>{}</div>", i,
                          i == 0 ? "" : " hidden", figures);
  }
  return section("profiles", "Axial profiles",
                 "Volume-weighted mean of each plane over height. The band is the mean 90 % interval of the "
                 "plane's cells, wider than that of their mean.",
                 "<div class=\"controls\"><label>held-out case<select id=\"profile-case\">" + options +
                     "</select></label></div>" + method_legend(report, true) + groups);
}

}  // namespace elrom::report
