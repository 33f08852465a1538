// The page of a scene's runs: which is nearest, what accuracy costs, and what went on over time.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "names.hpp"
#include "page_parts.hpp"
#include "scenes_page_parts.hpp"
#include "scenes_words.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using svg::escape;

std::string opening(const SceneReport& report) {
  return fmt::format(
      "<header><p class=\"over\">Scene <b>{}</b> &middot; {} run{} &middot; yardstick: {}</p><h1>{}</h1></header>",
      escape(report.runs.front().files.scene), report.runs.size(), report.runs.size() == 1 ? "" : "s",
      report.has_yardstick ? escape(report.runs[report.reference].name) : "none (no run by dem)",
      escape(headline(report)));
}

std::string error_text(const SceneReport& report, std::size_t i) {
  if (i == report.reference) return report.has_yardstick ? "yardstick" : "reference";
  return report.runs[i].error ? percent_text(*report.runs[i].error) : "-";
}

std::string run_row(const SceneReport& report, std::size_t i) {
  const auto& run = report.runs[i];
  const auto& files = run.files;
  const auto note = note_text(report, run);
  return fmt::format(
      "<tr><th>{}</th><td>{}</td><td>{}</td><td>{}</td><td>{:.0f}</td><td>{}</td><td>{}</td><td>{}</td>"
      "<td class=\"text\">{}</td></tr>",
      escape(run.name), error_text(report, i),
      files.collisions ? fmt::format("{:.0f}", *files.collisions) : "not counted",
      run.collision_error ? signed_percent(*run.collision_error) : "-", files.wall_hits, files.spheres,
      files.seconds ? run_time_text(*files.seconds) : "in parts", files.threads,
      run.differs.empty() ? escape(note)
                          : "<span class=\"verdict edge\">another setting</span> " + escape(note));
}

std::string runs_section(const SceneReport& report) {
  std::string rows;
  for (std::size_t i = 0; i < report.runs.size(); ++i) rows += run_row(report, i);
  return section(
      "runs", "Runs", report.runs.size() > 1 ? escape(error_meaning(report)) : std::string(),
      "<div class=\"scroll\"><table><thead><tr><th>model, step</th><th>error</th><th>collisions</th><th>to " +
          escape(reference_text(report)) +
          "</th><th>wall hits</th><th>spheres</th><th>run time</th><th>threads</th><th "
          "style=\"text-align:left\">note</th></tr></thead><tbody>" +
          rows + "</tbody></table></div>");
}

// Runs that have both, by time.
std::vector<std::size_t> points_of(const SceneReport& report) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < report.runs.size(); ++i)
    if (report.runs[i].error && report.runs[i].files.seconds) order.push_back(i);
  std::ranges::sort(order, {}, [&](std::size_t i) { return *report.runs[i].files.seconds; });
  return order;
}

std::string cost_chart(const SceneReport& report, const std::vector<std::size_t>& order) {
  std::vector<double> times, errors, front_times, front_errors;
  for (const auto i : order) {
    times.push_back(*report.runs[i].files.seconds);
    errors.push_back(100 * *report.runs[i].error);
    if (report.runs[i].front) front_times.push_back(times.back()), front_errors.push_back(errors.back());
  }
  auto all_times = times;
  const auto reference_time = report.runs[report.reference].files.seconds;
  if (reference_time) all_times.push_back(*reference_time);
  const auto x = svg::fit_axis("run time [s]", all_times, 0.0);
  auto y = svg::fit_axis("error [%]", errors, 1.0);
  if (y.scale == svg::Scale::linear) y.low = 0;
  svg::Chart chart({.width = 760, .height = 360, .right = 190}, x, y, "Error against run time");
  if (reference_time)
    chart.line(std::vector{*reference_time, *reference_time}, std::vector{y.low, y.high}, "rule",
               reference_text(report) + " itself");
  chart.line(front_times, front_errors, "noise", "the front");
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto& run = report.runs[order[k]];
    chart.points(std::span(&times[k], 1), std::span(&errors[k], 1), run_class(report, order[k]), run.name);
    chart.label(times[k], errors[k], run.name + (run.front ? " (front)" : ""));
  }
  return chart.text();
}

std::string cost_section_of(const SceneReport& report) {
  const auto order = points_of(report);
  if (order.empty()) return "";
  return section("cost", "What accuracy costs", escape(cost_sentence(report)),
                 figure("Each model and step: error against run time; grey: the front; dashed: " +
                            reference_text(report) + " itself",
                        cost_chart(report, order)));
}

// Differences by output of a count, a second.
std::vector<double> rates(const std::vector<double>& time, const std::vector<double>& count) {
  std::vector<double> rate(time.size(), std::nan(""));
  for (std::size_t i = 1; i < time.size(); ++i)
    if (time[i] > time[i - 1]) rate[i] = (count[i] - count[i - 1]) / (time[i] - time[i - 1]);
  return rate;
}

struct TimeLine {
  std::string heading, caption, label;
  bool is_count = false;  // drawn as a rate
};

bool counts(const SceneRunFiles& run, const TimeLine& line) {
  const bool of_collisions = line.heading.starts_with("collisions");
  return run.series.find(line.heading) != nullptr && (!of_collisions || run.collisions);
}

// Empty where no run has it, or all have nothing but 0.
std::string time_figure(const SceneReport& report, const TimeLine& wanted) {
  std::vector<double> all_times, all;
  std::vector<std::vector<double>> values(report.runs.size());
  for (std::size_t i = 0; i < report.runs.size(); ++i) {
    const auto& run = report.runs[i].files;
    if (!counts(run, wanted)) continue;
    const auto& time = *run.series.find("time [s]");
    const auto& column = *run.series.find(wanted.heading);
    values[i] = wanted.is_count ? rates(time, column) : column;
    all_times.insert(all_times.end(), time.begin(), time.end());
    all.insert(all.end(), values[i].begin(), values[i].end());
  }
  if (std::ranges::none_of(all, [](double v) { return v != 0 && std::isfinite(v); })) return "";
  all.push_back(0);
  svg::Chart chart({.width = 540, .height = 280, .left = 70}, svg::fit_axis("time [s]", all_times),
                   svg::fit_axis(wanted.label, all), wanted.caption);
  for (std::size_t k = report.runs.size(); k-- > 0;)
    if (!values[k].empty())
      chart.line(*report.runs[k].files.series.find("time [s]"), values[k], run_class(report, k),
                 report.runs[k].name);
  return figure(wanted.caption, chart.text());
}

std::vector<TimeLine> time_lines(const SceneReport& report) {
  std::vector<TimeLine> lines{{"collisions", "Collisions of all spheres", "collisions a second", true}};
  const auto& groups = report.groups();
  for (std::size_t a = 0; a < groups.size() && groups.size() > 1 && groups.size() <= 3; ++a)
    for (std::size_t b = a; b < groups.size(); ++b)
      lines.push_back({"collisions of " + groups[a] + " and " + groups[b],
                       "Collisions of " + groups[a] + " and " + groups[b], "collisions a second", true});
  lines.push_back({"wall_hits", "Wall hits", "hits a second", true});
  lines.push_back({"spheres", "Spheres or parcels in the domain", "number", false});
  lines.push_back({"kinetic_energy [J]", "Kinetic energy of the solids", "energy [J]", false});
  for (const auto& group : groups)
    lines.push_back({"mean height of " + group + " [m]", "Mean height of " + group, "z [m]", false});
  lines.push_back({"gas pressure at inlets [Pa]", "Gas pressure at the inlets", "pressure [Pa]", false});
  return lines;
}

std::string time_section(const SceneReport& report) {
  std::string figures;
  for (const auto& line : time_lines(report)) figures += time_figure(report, line);
  const bool one_counts =
      std::ranges::any_of(report.runs, [](const auto& run) { return run.files.collisions.has_value(); });
  return section("time", "Over time",
                 one_counts ? "Rates are differences of the counts from output to output."
                            : "No run counts collisions: none and hel compute no single one.",
                 run_legend(report) + "<div class=\"grid2\">" + figures + "</div>");
}

std::string files_section(const SceneReport& report) {
  std::string items;
  for (const auto& run : report.runs)
    items += fmt::format("<dt>{}</dt><dd>{}</dd>", escape(run.name), escape(run.files.folder.string()));
  return section("about", "Files", "", "<dl class=\"defs\">" + items + "</dl>");
}

}  // namespace

std::string run_class(const SceneReport& report, std::size_t run) {
  if (report.has_yardstick && run == report.reference) return "truth";
  // The second series' colour is a grey, which the yardstick and the front have.
  constexpr std::array order{0, 3, 4, 5, 2, 6, 7, 8};
  const auto place = report.has_yardstick && run > report.reference ? run - 1 : run;
  return fmt::format("s{}", order[place % order.size()]);
}

std::string run_legend(const SceneReport& report) {
  std::string items;
  for (std::size_t i = 0; i < report.runs.size(); ++i)
    items +=
        fmt::format("<li><i class=\"{}\"></i>{}{}</li>", run_class(report, i), escape(report.runs[i].name),
                    report.has_yardstick && i == report.reference ? " (yardstick)" : "");
  return "<ul class=\"legend\">" + items + "</ul>";
}

std::string html_page(const SceneReport& report) {
  const auto& scene = report.runs.front().files.scene;
  std::string content = opening(report), links;
  const auto add = [&](const char* id, const char* title, const std::string& text) {
    if (text.empty()) return;
    links += fmt::format("<a href=\"#{}\">{}</a>", id, title);
    content += text;
  };
  add("runs", "Runs", runs_section(report));
  add("cost", "Cost", cost_section_of(report));
  add("positions", "Positions", positions_section(report));
  add("fractions", "Fractions", fractions_section(report));
  add("profiles", "Profiles", profiles_section(report));
  add("time", "Over time", time_section(report));
  content += files_section(report) + "<footer>" + escape(program_version()) + "</footer>";
  return whole_page("ELROM scene: " + scene, links, content);
}

}  // namespace elrom::report
