// The page of the collision models.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "collisions_words.hpp"
#include "elrom/base/text.hpp"
#include "names.hpp"
#include "page_parts.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using svg::escape;

std::string series(std::size_t model) { return fmt::format("s{}", model % 10); }

std::string legend(const CollisionReport& report) {
  std::string items;
  for (std::size_t i = 0; i < report.models.size(); ++i)
    items += fmt::format("<li><i class=\"{}\"></i>{}</li>", series(i), escape(report.models[i].name));
  return "<ul class=\"legend\">" + items + "</ul>";
}

std::string opening(const CollisionReport& report) {
  return fmt::format(
      "<header><p class=\"over\">Collision models on the set <b>{}</b> &middot; {} of its {} pairs judge</p>"
      "<h1>{}</h1></header>",
      escape(report.set.filename().string()), report.n_judged, report.summary.n_pairs,
      escape(headline(report)));
}

std::string set_section(const CollisionReport& report) {
  std::string items;
  for (const auto& sentence : set_sentences(report))
    items += "<p class=\"lead\">" + escape(sentence) + "</p>";
  return section("set", "The collisions", "", items);
}

std::string model_row(const CollisionReport& report, const CollisionModelReport& model) {
  const auto& errors = model.errors;
  std::string cells;
  for (const double mae : errors.mae) cells += "<td>" + base::rounded(mae, 3) + "</td>";
  cells += fmt::format("<td>{}</td><td>{:.2g}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.3g}</td>",
                       base::rounded(errors.mae_surface, 3), errors.momentum_error,
                       percent_text(errors.energy_gain, 2), percent_text(errors.gaining_share),
                       model.training_seconds ? base::duration(*model.training_seconds) : "not kept",
                       1 / model.call_seconds);
  const auto mark = mark_text(report, model);
  return fmt::format("<tr><th>{}</th>{}<td class=\"text\">{}</td></tr>", escape(model.name), cells,
                     model.differs.empty()
                         ? escape(mark)
                         : "<span class=\"verdict outside\">misleading</span> " + escape(mark));
}

std::string source_rows(const CollisionReport& report) {
  const bool any = std::any_of(report.models.begin(), report.models.end(), [](const auto& model) {
    return model.kind == particle::SurrogateKind::document;
  });
  if (!any) return "";
  std::string rows;
  for (const auto& printed : source_mae) {
    std::string cells;
    for (const double mae : printed.mae) cells += fmt::format("<td>{:.4f}</td>", mae);
    rows += fmt::format(
        "<tr><th>the source's, {:.0f} um</th>{}<td colspan=\"6\"></td><td class=\"text\">as printed; its pairs "
        "are of the protocol document, with capped speeds and pairs that start overlapped</td></tr>",
        printed.diameter * 1e6, cells);
  }
  return rows;
}

std::string model_section(const CollisionReport& report) {
  std::string rows;
  for (const auto& model : report.models) rows += model_row(report, model);
  return section(
      "models", "Models",
      "Mean absolute errors of the velocity components of both spheres and of r w, in m/s. Momentum: greatest change "
      "of a pair's, as a share of |p1| + |p2|. Energy: the most that a pair was given, as a share of its own, and how "
      "many were given any. Calls: pairs in a second of one core, measured here.",
      "<div class=\"scroll\"><table class=\"tight\"><thead><tr><th>model</th><th>u</th><th>v</th><th>w</th><th>r w</th>"
      "<th>momentum</th><th>energy given</th><th>pairs given</th><th>training</th><th>calls/s</th><th "
      "style=\"text-align:left\">note</th></tr></thead><tbody>" +
          rows + source_rows(report) + "</tbody></table></div>");
}

std::string parity_section(const CollisionReport& report) {
  constexpr std::array component{"u", "v", "w"};
  std::string body;
  for (std::size_t i = 0; i < report.models.size(); ++i) {
    const auto& model = report.models[i];
    std::string figures;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& map = model.figures.parity[k];
      const std::string name = component[k];
      figures += figure(name, parity_drawing(map, {name + ", two-particle DEM [m/s]", map.low, map.high},
                                             {name + ", model [m/s]", map.low, map.high}, series(i),
                                             "Parity of " + name + ", " + model.name));
    }
    body += fmt::format("<h3>{}</h3><div class=\"grid3\">{}</div>", escape(model.name), figures);
  }
  return section(
      "parity", "Parity by component",
      "Velocity after the collision, both spheres, model against two-particle DEM (darker: more pairs, on "
      "a logarithmic scale).",
      body);
}

// One line a model over bins, errors on a logarithmic scale.
std::string binned_chart(const CollisionReport& report, const std::string& label,
                         const std::vector<double>& edges,
                         const std::function<const std::vector<double>&(const CollisionFigures&)>& values) {
  std::vector<double> middles, everything;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) middles.push_back(0.5 * (edges[i] + edges[i + 1]));
  for (const auto& model : report.models)
    for (const double value : values(model.figures))
      if (value > 0) everything.push_back(value);
  svg::Chart chart({.width = 540, .height = 320}, {label, edges.front(), edges.back()},
                   svg::fit_axis("mean |error| [m/s]", everything, 0.3), "Error against " + label);
  for (std::size_t i = report.models.size(); i-- > 0;) {
    chart.line(middles, values(report.models[i].figures), series(i), report.models[i].name);
    chart.points(middles, values(report.models[i].figures), series(i), report.models[i].name);
  }
  return chart.text();
}

std::string relative_chart(const CollisionReport& report) {
  double most = 0;
  std::vector<std::vector<double>> shares;
  for (const auto& model : report.models) {
    const auto& histogram = model.figures.relative;
    const auto total = static_cast<double>(std::max<std::uint64_t>(1, histogram.total()));
    auto& list = shares.emplace_back();
    for (const auto count : histogram.counts) list.push_back(100 * static_cast<double>(count) / total);
    most = std::max(most, *std::max_element(list.begin(), list.end()));
  }
  const auto& bins = report.models.front().figures.relative;
  const double step = (bins.high - bins.low) / static_cast<double>(bins.counts.size());
  svg::Chart chart({.width = 860, .height = 320},
                   {"|error of the velocity| / |velocity after|", std::pow(10.0, bins.low),
                    std::pow(10.0, bins.high), svg::Scale::log},
                   {"spheres [%]", 0, most > 0 ? 1.08 * most : 1}, "Distribution of relative errors");
  for (std::size_t m = report.models.size(); m-- > 0;) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < shares[m].size(); ++i)
      for (const std::size_t edge : {i, i + 1}) {
        x.push_back(std::pow(10.0, bins.low + step * static_cast<double>(edge)));
        y.push_back(shares[m][i]);
      }
    chart.line(x, y, series(m), report.models[m].name);
  }
  return chart.text();
}

std::string error_section(const CollisionReport& report) {
  const auto by_speed = figure(
      "Against the relative speed",
      binned_chart(report, "relative speed [m/s]", report.speed_edges,
                   [](const CollisionFigures& f) -> const std::vector<double>& { return f.by_speed; }));
  const bool central = report.summary.impact_angle.most < 1e-6;
  const auto by_angle = figure(
      "Against the angle of impact",
      central
          ? std::string("<p class=\"lead\">Every collision of this set is central: there is no angle.</p>")
          : binned_chart(report, "angle between relative velocity and normal [degrees]", report.angle_edges,
                         [](const CollisionFigures& f) -> const std::vector<double>& { return f.by_angle; }));
  return section("errors", "Where the errors are",
                 "Errors below the left edge and above the right one are counted in the outer bins of the "
                 "distribution. The lines below it are means of the components of both spheres.",
                 legend(report) + figure("Distribution of relative errors", relative_chart(report)) +
                     "<div class=\"grid2\">" + by_angle + by_speed + "</div>");
}

std::string balance_section(const CollisionReport& report) {
  const auto lost_truth = report.models.front().errors.energy_lost_truth;
  std::vector<svg::BarRow> lost{
      {"two-particle DEM", {{100 * lost_truth, "truth", "two-particle DEM"}}, percent_text(lost_truth, 2)}},
      momentum;
  for (std::size_t i = 0; i < report.models.size(); ++i) {
    const auto& model = report.models[i];
    lost.push_back({model.name,
                    {{100 * model.errors.energy_lost, series(i), model.name}},
                    percent_text(model.errors.energy_lost, 2)});
    momentum.push_back({model.name,
                        {{100 * model.errors.mean_momentum_error, series(i), model.name}},
                        fmt::format("{:.2g}", model.errors.mean_momentum_error)});
  }
  return section(
      "balance", "Momentum and energy",
      "A collision keeps momentum and loses some energy. Energy: of all pairs together; a model may lose the right "
      "amount on average and still give energy to some pairs.",
      "<div class=\"grid2\">" +
          figure("Kinetic energy lost", svg::bars(lost, "of the energy of all pairs [%]", "Energy lost")) +
          figure("Momentum made or lost, mean of the pairs",
                 svg::bars(momentum, "change / (|p1| + |p2|) [%]", "Momentum error")) +
          "</div>");
}

std::string cost_chart(const CollisionReport& report, const std::string& label,
                       const std::function<double(const CollisionModelReport&)>& time) {
  std::vector<double> times, errors;
  for (const auto& model : report.models) {
    times.push_back(time(model));
    errors.push_back(model.errors.mae_velocity);
  }
  if (std::none_of(times.begin(), times.end(), [](double t) { return t > 0; }))
    return "<p class=\"lead\">not kept</p>";
  svg::Chart chart({.width = 540, .height = 340, .right = 130}, svg::fit_axis(label, times, 0.0),
                   svg::fit_axis("mean absolute error [m/s]", errors, 0.0), "Error against " + label);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(times[i] > 0) || !(errors[i] > 0)) continue;
    chart.points(std::span(&times[i], 1), std::span(&errors[i], 1), series(i), report.models[i].name);
    chart.label(times[i], errors[i], report.models[i].name);
  }
  return chart.text();
}

std::string cost_section(const CollisionReport& report) {
  return section(
      "cost", "What accuracy costs", escape(cost_sentence(report)),
      "<div class=\"grid2\">" +
          figure("A call", cost_chart(report, "a call on one core [ns]",
                                      [](const CollisionModelReport& m) { return 1e9 * m.call_seconds; })) +
          figure("Training", cost_chart(report, "training [s]",
                                        [](const CollisionModelReport& m) {
                                          return m.training_seconds.value_or(std::nan(""));
                                        })) +
          "</div>");
}

std::string provenance_section(const CollisionReport& report) {
  std::string items =
      fmt::format("<dt>Set</dt><dd>{} ({})</dd>", escape(report.set.filename().string()), report.digest);
  for (const auto& model : report.models)
    items +=
        fmt::format("<dt>{}</dt><dd>{}</dd>", escape(model.name), escape(model.file.filename().string()));
  return section("about", "Files", "", "<dl class=\"defs\">" + items + "</dl>");
}

}  // namespace

std::string html_page(const CollisionReport& report) {
  return whole_page("ELROM collisions: " + report.set.filename().string(),
                    "<a href=\"#set\">Set</a><a href=\"#models\">Models</a><a href=\"#parity\">Parity</a><a "
                    "href=\"#errors\">Errors</a><a href=\"#balance\">Balance</a><a href=\"#cost\">Cost</a>",
                    opening(report) + set_section(report) + model_section(report) + cost_section(report) +
                        error_section(report) + balance_section(report) + parity_section(report) +
                        provenance_section(report));
}

}  // namespace elrom::report
