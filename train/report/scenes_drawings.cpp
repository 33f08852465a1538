// Profiles, positions and volume fractions of a scene's runs, drawn.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "colour_map.hpp"
#include "page_parts.hpp"
#include "scenes_page_parts.hpp"
#include "scenes_words.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using svg::escape;

constexpr std::size_t most_stations = 24;
constexpr std::size_t most_dots = 15'000;  // of a picture
constexpr const char* axis_names = "xyz";

struct LengthUnit {
  const char* symbol;
  double factor;
};
LengthUnit length_unit(double extent) { return extent < 1 ? LengthUnit{"mm", 1e3} : LengthUnit{"m", 1}; }

double extent_of(const std::vector<double>& centres) { return centres.back() - centres.front(); }

/// Two directions of a section, the longer one along it.
struct Plane {
  std::size_t along = 0, across = 0;
};

// By number of cells, then by length; one direction alone is the one across.
Plane plane_of(const SceneSection& section) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return extent_of(section.centres[a]) > extent_of(section.centres[b]);
  });
  if (section.centres[order[1]].size() == 1) return {order[1], order[0]};
  return {order[0], order[1]};
}

/// Means over the direction that a plane leaves out.
struct Flat {
  std::vector<double> fraction;                      // (along, across), across fastest
  std::array<std::vector<double>, 3> velocity = {};  // NaN where nothing is
  std::vector<double> pressure = {};                 // empty without a coupled gas
};

Flat flattened(const SceneSection& section, const Plane& plane) {
  const auto& c = section.centres;
  const auto n_across = c[plane.across].size();
  const auto n = c[plane.along].size() * n_across;
  const double depth = static_cast<double>(section.fraction.size()) / static_cast<double>(n);
  Flat flat{.fraction = std::vector<double>(n)};
  flat.velocity.fill(std::vector<double>(n));
  if (!section.pressure.empty()) flat.pressure.assign(n, 0);
  for (std::size_t k = 0; k < section.fraction.size(); ++k) {
    const std::array<std::size_t, 3> index{k % c[0].size(), k / c[0].size() % c[1].size(),
                                           k / c[0].size() / c[1].size()};
    const auto to = index[plane.along] * n_across + index[plane.across];
    flat.fraction[to] += section.fraction[k] / depth;
    for (std::size_t a = 0; a < 3; ++a) flat.velocity[a][to] += section.flux[a][k] / depth;
    if (!section.pressure.empty()) flat.pressure[to] += section.pressure[k] / depth;
  }
  for (auto& component : flat.velocity)
    for (std::size_t k = 0; k < n; ++k)
      component[k] = flat.fraction[k] > 0 ? component[k] / flat.fraction[k] : std::nan("");
  return flat;
}

/// The same section of all runs, flat; none where a run has other cells.
struct Compared {
  const SceneSection* section = nullptr;
  Plane plane;
  LengthUnit unit{};
  std::vector<std::optional<Flat>> runs = {};
};

Compared compared(const SceneReport& report, const SceneSection& section) {
  Compared result{.section = &section, .plane = plane_of(section)};
  result.unit = length_unit(extent_of(section.centres[result.plane.along]) +
                            extent_of(section.centres[result.plane.across]));
  for (const auto& run : report.runs) {
    const auto found = std::ranges::find_if(run.files.sections, [&](const SceneSection& other) {
      return other.name == section.name && other.centres == section.centres;
    });
    result.runs.push_back(found == run.files.sections.end() ? std::nullopt
                                                            : std::optional(flattened(*found, result.plane)));
  }
  return result;
}

struct Quantity {
  std::string caption, label;
  std::size_t component = 3;  // 3: the fraction; 4: the pressure
  [[nodiscard]] const std::vector<double>& of(const Flat& flat) const {
    return component == 3 ? flat.fraction : component == 4 ? flat.pressure : flat.velocity[component];
  }
};

std::vector<Quantity> quantities_of(const Compared& at) {
  std::vector<Quantity> quantities{{"Volume fraction", "fraction", 3}};
  // Across a height, too, solids rise and fall.
  for (std::size_t a = 0; a < 3; ++a)
    if (a == 2 || ((a == at.plane.along || a == at.plane.across) && at.section->centres[a].size() > 1))
      quantities.push_back({fmt::format("Velocity of the solids along {}", axis_names[a]),
                            fmt::format("{}-velocity [m/s]", axis_names[a]), a});
  if (std::ranges::all_of(at.runs, [](const auto& run) { return !run || !run->pressure.empty(); }))
    quantities.push_back({"Pressure of the gas", "pressure [Pa]", 4});
  return quantities;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

std::string station_chart(const SceneReport& report, const Compared& at, const Quantity& quantity,
                          std::size_t station) {
  const auto x = scaled(at.section->centres[at.plane.across], at.unit.factor);
  std::vector<double> all;
  const auto values_of = [&](const Flat& flat) {
    return std::span(quantity.of(flat)).subspan(station * x.size(), x.size());
  };
  for (const auto& run : at.runs)
    if (run) all.insert(all.end(), values_of(*run).begin(), values_of(*run).end());
  if (quantity.component == 3) all.push_back(0);
  svg::Chart chart({.width = 280, .height = 190, .left = 66, .clip = true},
                   svg::fit_axis(fmt::format("{} [{}]", axis_names[at.plane.across], at.unit.symbol), x),
                   svg::fit_axis(quantity.label, all), quantity.caption);
  for (std::size_t run = at.runs.size(); run-- > 0;)
    if (at.runs[run]) chart.line(x, values_of(*at.runs[run]), run_class(report, run), report.runs[run].name);
  return chart.text();
}

std::string profiles_of(const SceneReport& report, const SceneSection& section) {
  const auto at = compared(report, section);
  const auto& stations = at.section->centres[at.plane.along];
  const std::size_t every = (stations.size() + most_stations - 1) / most_stations;
  std::string text = fmt::format("<h3>Section {}{}</h3>", escape(section.name),
                                 every > 1 ? fmt::format(": every {}th of {} places along {}", every,
                                                         stations.size(), axis_names[at.plane.along])
                                           : "");
  for (const auto& quantity : quantities_of(at)) {
    std::string charts;
    for (std::size_t k = 0; k < stations.size(); k += every)
      charts += figure(stations.size() > 1 ? fmt::format("{} = {:.4g} {}", axis_names[at.plane.along],
                                                         stations[k] * at.unit.factor, at.unit.symbol)
                                           : quantity.caption,
                       station_chart(report, at, quantity, k));
    const bool is_first = quantity.component == 3;
    text += fmt::format("<details{}><summary>{}, {} place{}</summary><div class=\"grid4\">{}</div></details>",
                        is_first ? " open" : "", quantity.caption, (stations.size() + every - 1) / every,
                        stations.size() == 1 ? "" : "s", charts);
  }
  return text;
}

/// A picture in which both directions have one scale.
struct Frame {
  svg::Size size;
  svg::Axis x, y;
};

Frame true_to_scale(svg::Axis x, svg::Axis y) {
  const double ratio = (y.high - y.low) / (x.high - x.low);
  svg::Size size{.left = 50, .top = 8};
  const double inner_width = std::max(ratio > 1 ? 460 / ratio : 480.0, 40.0);
  size.width = inner_width + size.left + size.right;
  size.height = std::clamp(inner_width * ratio, 40.0, 460.0) + size.top + size.bottom;
  return {size, std::move(x), std::move(y)};
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void add(double value) { low = std::min(low, value), high = std::max(high, value); }
  [[nodiscard]] double extent() const { return high > low ? high - low : 0; }
};

std::array<Range, 3> ranges_of(const SceneReport& report) {
  std::array<Range, 3> ranges;
  for (const auto& run : report.runs)
    for (std::size_t a = 0; run.files.points && a < 3; ++a)
      for (const float value : run.files.points->place[a]) ranges[a].add(value);
  return ranges;
}

// The two longest directions; what is upright stays upright.
std::pair<std::size_t, std::size_t> picture_directions(const std::array<Range, 3>& ranges) {
  std::array<std::size_t, 3> order{0, 1, 2};
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return ranges[a].extent() > ranges[b].extent(); });
  return std::minmax(order[0], order[1]);
}

std::string group_class(std::size_t group) {
  constexpr std::array order{0, 3, 4, 5, 2, 6, 7, 8};
  return fmt::format("s{}", order[group % order.size()]);
}

std::string group_legend(const std::vector<std::string>& groups) {
  std::string items;
  for (std::size_t g = 0; g < groups.size(); ++g)
    items += fmt::format("<li><i class=\"{}\"></i>{}</li>", group_class(g), escape(groups[g]));
  return "<ul class=\"legend\">" + items + "</ul>";
}

std::string points_chart(const SceneRunReport& run, const std::vector<std::string>& groups,
                         const Frame& frame, std::pair<std::size_t, std::size_t> directions, double factor) {
  const auto& points = *run.files.points;
  const std::size_t every = (points.group.size() + most_dots - 1) / most_dots;
  svg::Chart chart(frame.size, frame.x, frame.y, "Positions, " + run.name);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::vector<double> x, y;
    for (std::size_t i = 0; i < points.group.size(); i += every) {
      if (static_cast<std::size_t>(points.group[i]) != g) continue;
      x.push_back(factor * points.place[directions.first][i]);
      y.push_back(factor * points.place[directions.second][i]);
    }
    chart.dots(x, y, group_class(g), groups[g]);
  }
  return chart.text();
}

svg::Axis padded(const Range& range, std::size_t axis, const LengthUnit& unit, double room) {
  return {fmt::format("{} [{}]", axis_names[axis], unit.symbol), unit.factor * (range.low - room),
          unit.factor * (range.high + room)};
}

/// Colours of a logarithmic scale.
struct LogColours {
  double low, high;
  ColourMap map = sequential_map();
  [[nodiscard]] std::string of(double value) const {
    const double share = std::clamp(std::log(value / low) / std::log(high / low), 0.0, 1.0);
    const auto c = map[static_cast<std::size_t>(std::lround(255 * share))];
    return fmt::format("#{:02x}{:02x}{:02x}", c.r, c.g, c.b);
  }
};

// From the smallest fraction to the largest, at most four decades.
std::optional<LogColours> colours_for(const Compared& at) {
  Range range;
  for (const auto& run : at.runs)
    if (run)
      for (const double value : run->fraction)
        if (value > 0) range.add(value);
  if (!(range.high > 0)) return {};
  return LogColours{std::max(std::min(range.low, 0.5 * range.high), 1e-4 * range.high), range.high};
}

std::string colour_bar(const LogColours& colours) {
  constexpr int n = 96;
  svg::Chart chart({.width = 420, .height = 62, .left = 2},
                   {"volume fraction of the solids", colours.low, colours.high, svg::Scale::log}, {"", 0, 1},
                   "Colours of the volume fractions");
  const auto at = [&](int k) { return colours.low * std::pow(colours.high / colours.low, k / double{n}); };
  for (int k = 0; k < n; ++k) chart.tile(at(k), at(k + 1) * 1.01, 0, 1, colours.of(at(k)), "");
  return chart.text();
}

/// Where a cell begins and ends.
std::pair<double, double> cell_between(const std::vector<double>& centres, std::size_t k) {
  const double half = 0.5 * extent_of(centres) / static_cast<double>(centres.size() - 1);
  return {centres[k] - half, centres[k] + half};
}

Range cells_range(const std::vector<double>& centres) {
  return {cell_between(centres, 0).first, cell_between(centres, centres.size() - 1).second};
}

std::string fraction_chart(const Compared& at, const Flat& flat, const LogColours& colours,
                           const std::string& title) {
  const auto& c = at.section->centres;
  const auto [h, v] = std::minmax(at.plane.along, at.plane.across);
  const auto frame =
      true_to_scale(padded(cells_range(c[h]), h, at.unit, 0), padded(cells_range(c[v]), v, at.unit, 0));
  svg::Chart chart(frame.size, frame.x, frame.y, title);
  for (std::size_t i = 0; i < c[h].size(); ++i)
    for (std::size_t j = 0; j < c[v].size(); ++j) {
      const auto along = h == at.plane.along ? i : j, across = h == at.plane.along ? j : i;
      const double value = flat.fraction[along * c[at.plane.across].size() + across];
      if (!(value > 0)) continue;
      const auto [left, right] = cell_between(c[h], i);
      const auto [bottom, top] = cell_between(c[v], j);
      const double f = at.unit.factor;
      chart.tile(f * left, f * right, f * bottom, f * top, colours.of(value), fmt::format("{:.3g}", value));
    }
  return chart.text();
}

std::string fractions_of(const SceneReport& report, const SceneSection& section) {
  const auto at = compared(report, section);
  const auto colours = colours_for(at);
  if (!colours || section.centres[at.plane.along].size() < 2 || section.centres[at.plane.across].size() < 2)
    return "";
  std::string charts;
  for (std::size_t run = 0; run < at.runs.size(); ++run)
    if (at.runs[run])
      charts += figure(report.runs[run].name, fraction_chart(at, *at.runs[run], *colours,
                                                             "Volume fraction, " + report.runs[run].name));
  return fmt::format("<h3>Section {}</h3>{}<div class=\"grid2\">{}</div>", escape(section.name),
                     colour_bar(*colours), charts);
}

}  // namespace

std::string profiles_section(const SceneReport& report) {
  std::string text;
  for (const auto& one : report.runs[report.reference].files.sections) text += profiles_of(report, one);
  if (text.empty()) return "";
  return section("profiles", "Profiles at every section",
                 escape(fmt::format("Means over the outputs from {} on{}. Each place has a scale of its own.",
                                    time_text(report.from),
                                    report.has_yardstick ? "; the thick line is DEM" : "; no run is by DEM")),
                 run_legend(report) + text);
}

std::string positions_section(const SceneReport& report) {
  const auto ranges = ranges_of(report);
  const auto directions = picture_directions(ranges);
  const auto &x = ranges[directions.first], &y = ranges[directions.second];
  if (!(x.extent() > 0 || y.extent() > 0)) return "";
  const auto unit = length_unit(std::max(x.extent(), y.extent()));
  const double room = 0.02 * std::max(x.extent(), y.extent());
  const auto frame =
      true_to_scale(padded(x, directions.first, unit, room), padded(y, directions.second, unit, room));
  std::string charts;
  bool thinned = false;
  for (const auto& run : report.runs) {
    if (!run.files.points) continue;
    thinned = thinned || run.files.points->group.size() > most_dots;
    charts += figure(run.name, points_chart(run, report.groups(), frame, directions, unit.factor));
  }
  return section("positions", "Where the spheres are at the end",
                 std::string("Seen along the shortest direction, to scale, coloured by group.") +
                     (thinned ? fmt::format(" Of more than {} spheres, every few only.", most_dots) : ""),
                 group_legend(report.groups()) + "<div class=\"grid2\">" + charts + "</div>");
}

std::string fractions_section(const SceneReport& report) {
  std::string text;
  for (const auto& one : report.runs[report.reference].files.sections) text += fractions_of(report, one);
  if (text.empty()) return "";
  return section("fractions", "Volume fractions in the cells",
                 "Means in time, on a logarithmic scale of at most four decades; empty cells are blank.",
                 text);
}

}  // namespace elrom::report
