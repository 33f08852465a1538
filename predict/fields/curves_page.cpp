#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/field/user_unit.hpp"
#include "summary.hpp"

namespace elrom::fields {
namespace {

constexpr double width = 420, height = 260, left = 70, right = 12, top = 26, bottom = 40;
constexpr std::array<const char*, 8> colours{"#1f6fb4", "#d1661c", "#2a8f4a", "#8d4bb5",
                                             "#7a5c3a", "#c8408f", "#5f6b73", "#a09a1a"};
constexpr const char* style = R"(
<style>
body { font: 14px/1.4 sans-serif; margin: 2em auto; max-width: 1360px; padding: 0 1em; color: #222 }
svg { margin: 6px; background: #fff } figure { display: inline-block; margin: 0 }
text { font-size: 11px; fill: #222 } .grid { stroke: #ddd } .edge { fill: #fff; stroke-width: 2 }
.outside { fill: #fff; stroke: #c00; stroke-width: 2 } .key { display: inline-block; margin-right: 1.5em }
</style>
)";

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += c == '<'   ? "&lt;"
              : c == '>' ? "&gt;"
              : c == '&' ? "&amp;"
              : c == '"' ? "&quot;"
                         : std::string(1, c);
  return result;
}

struct Point {
  double x, y;
  std::size_t i_case;
};
struct Line {
  std::string name;
  std::vector<std::size_t> cases;
};

/// The round step nearest above a fifth of the range: 1, 2 or 5 times a power of ten.
double tick_step(double range) {
  const double rough = range / 5, power = std::pow(10, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= rough) return step * power;
  return 10 * power;
}

/// From values to places on the paper.
struct Axis {
  double low = 0, high = 0, from, to;

  Axis(const std::vector<double>& values, double from_place, double to_place)
      : from(from_place), to(to_place) {
    const auto [least, most] = std::ranges::minmax(values);
    const double size = std::max({std::abs(least), std::abs(most), 1e-30});
    const double margin = most - least > 1e-9 * size ? 0.05 * (most - least) : 0.05 * size;
    low = least - margin;
    high = most + margin;
  }
  [[nodiscard]] double at(double value) const { return from + (value - low) / (high - low) * (to - from); }
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> result;
    const double step = tick_step(high - low);
    for (double k = std::ceil(low / step); k * step <= high; ++k) result.push_back(k * step);
    return result;
  }
};

void draw_axes(const Axis& x, const Axis& y, std::string& svg) {
  for (const double tick : x.ticks()) {
    svg += fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/>",
                       x.at(tick), top, height - bottom);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>", x.at(tick),
                       height - bottom + 14, base::rounded(tick));
  }
  for (const double tick : y.ticks()) {
    svg += fmt::format("<line class=\"grid\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>", left,
                       width - right, y.at(tick));
    svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", left - 4, y.at(tick) + 4,
                       base::rounded(tick, 5));
  }
}

void draw_line(const Summary& summary, const std::vector<Point>& points, const Axis& x, const Axis& y,
               const char* colour, std::string& svg) {
  std::string path;
  for (const auto& point : points) path += fmt::format("{:.1f},{:.1f} ", x.at(point.x), y.at(point.y));
  svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\"/>", path, colour);
  for (const auto& point : points) {
    const auto& result = summary.results[point.i_case];
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\" stroke=\"{}\" class=\"{}\"><title>{}: {}, "
        "{}</title></circle>",
        x.at(point.x), y.at(point.y), colour, colour, model::name_of(result.verdict),
        escaped(summary.list.cases[point.i_case].name), base::rounded(point.y, 5), escaped(result.reason));
  }
}

std::string chart(const Summary& summary, const std::vector<Line>& lines, const CaseList::Moved& swept,
                  std::size_t figure) {
  const auto& info = summary.schema[swept.input];
  const auto& unit = *swept.unit;
  std::vector<std::vector<Point>> points;
  std::vector<double> xs, ys;
  for (const auto& line : lines) {
    points.emplace_back();
    for (const auto k : line.cases) {
      const auto& figures = summary.results[k].figures;
      if (figures.empty() || !std::isfinite(figures[figure])) continue;
      xs.push_back(unit.from_si(summary.list.cases[k].values[swept.input]));
      ys.push_back(figures[figure]);
      points.back().push_back({xs.back(), ys.back(), k});
    }
    std::ranges::sort(points.back(), {}, &Point::x);
  }
  if (xs.empty()) return "";
  const Axis x(xs, left, width - right), y(ys, height - bottom, top);
  std::string svg = fmt::format("<figure><svg width=\"{}\" height=\"{}\">", width, height);
  draw_axes(x, y, svg);
  for (std::size_t i = 0; i < points.size(); ++i)
    draw_line(summary, points[i], x, y, colours[i % colours.size()], svg);
  svg += fmt::format("<text x=\"{}\" y=\"14\" font-weight=\"bold\">{}</text>", left,
                     escaped(summary.figure_names[figure]));
  svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{} [{}]</text></svg></figure>\n",
                     (left + width - right) / 2, height - 6, escaped(info.name), escaped(unit.symbol));
  return svg;
}

/// Cases that differ in one swept input alone, with the base that they were made from.
std::vector<Line> lines_over(const Summary& summary, std::size_t input) {
  const auto& list = summary.list;
  std::map<std::vector<double>, Line> lines;  // by base and the other swept inputs
  for (std::size_t k = 0; k < list.cases.size(); ++k) {
    const auto& origin = list.origins[k];
    const bool is_base = origin.base == k;
    if (!is_base && std::ranges::find(origin.changed, input) == origin.changed.end()) continue;
    std::vector<double> key{static_cast<double>(origin.base)};
    std::string name = list.cases[origin.base].name;
    for (const auto& other : list.swept) {
      if (other.input == input) continue;
      const double value = list.cases[k].values[other.input];
      key.push_back(value);
      if (origin.changed.size() > 1)
        name += ", " + summary.schema[other.input].name + " " + base::rounded(other.unit->from_si(value)) +
                " " + other.unit->symbol;
    }
    auto& line = lines[key];
    if (line.cases.empty()) line.name = name;
    line.cases.push_back(k);
  }
  std::vector<Line> result;
  for (auto& [key, line] : lines)
    if (line.cases.size() > 1) result.push_back(std::move(line));
  return result;
}

/// What a curve does not show by itself.
std::string held_sentence(const Summary& summary) {
  std::string text = "Inputs that are not swept are held at the base's values.";
  const auto n = n_held_alone(summary);
  if (n == 0) return text;
  return text +
         fmt::format(
             " In {} of the cases mass or pressure are unlike the training cases', and in their bases they are "
             "not: the swept inputs moved, and those that move with them in a furnace were held. There the "
             "gas balance tells of that combination, and not of the model.",
             n);
}

}  // namespace

std::string curves_page(const Summary& summary, std::span<const std::size_t> curves) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>ELROM: what if</title>";
  html +=
      std::string(style) + "</head><body>\n<h1>What if</h1>\n<p>" +
      std::to_string(summary.list.cases.size()) + " cases, " + escaped(program_version()) +
      ". Full points lie inside what was trained, hollow ones at its edge, hollow red ones outside.</p>\n<p>" +
      held_sentence(summary) + "</p>\n";
  for (const auto& swept : summary.list.swept) {
    const auto lines = lines_over(summary, swept.input);
    html += "<h2>" + escaped(summary.schema[swept.input].name) + "</h2>\n<p>";
    for (std::size_t i = 0; i < lines.size(); ++i)
      html += fmt::format("<span class=\"key\" style=\"color:{}\">&#9679; {}</span>",
                          colours[i % colours.size()], escaped(lines[i].name));
    html += "</p>\n";
    for (const auto figure : curves) html += chart(summary, lines, swept, figure);
  }
  return html + "</body></html>\n";
}

}  // namespace elrom::fields
