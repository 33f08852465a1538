// The viewer of vertical cuts. Values travel as 16-bit steps between each series' extremes, in base64: about
// 11 bytes a cell and series less than as text, and finer than any screen shows.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base64.hpp"
#include "colour_map.hpp"
#include "names.hpp"
#include "page_parts.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using Json = nlohmann::ordered_json;
constexpr double steps = 65535;

void append_u16(std::vector<std::uint8_t>& bytes, double value) {
  const auto step = static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, steps)));
  bytes.push_back(static_cast<std::uint8_t>(step & 0xff));
  bytes.push_back(static_cast<std::uint8_t>(step >> 8));
}

Json pack(const std::vector<float>& values) {
  if (values.empty()) return {};
  double low = 0, high = 0;
  bool any = false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = any ? std::min(low, value) : value;
    high = any ? std::max(high, value) : value;
    any = true;
  }
  if (!(high > low)) high = low + std::max(1e-30, std::abs(low));
  std::vector<std::uint8_t> bytes;
  bytes.reserve(2 * values.size());
  for (const double value : values)
    append_u16(bytes, std::isfinite(value) ? (value - low) / (high - low) * steps : 0);
  return {{"low", low}, {"high", high}, {"data", base64(bytes)}};
}

// Corners as steps from the cut's lower left end.
Json pack_cut(const Cut& cut) {
  double low[2] = {cut.corners[0][0], cut.corners[0][1]}, reach = 0;
  for (const auto& quad : cut.corners)
    for (std::size_t k = 0; k < quad.size(); ++k) low[k % 2] = std::min<double>(low[k % 2], quad[k]);
  for (const auto& quad : cut.corners)
    for (std::size_t k = 0; k < quad.size(); ++k) reach = std::max(reach, quad[k] - low[k % 2]);
  const double step = reach > 0 ? reach / steps : 1;
  std::vector<std::uint8_t> bytes;
  for (const auto& quad : cut.corners)
    for (std::size_t k = 0; k < quad.size(); ++k) append_u16(bytes, (quad[k] - low[k % 2]) / step);
  return {{"title", cut.title},
          {"horizontal", cut.horizontal},
          {"vertical", cut.vertical},
          {"low", {low[0], low[1]}},
          {"step", step},
          {"corners", base64(bytes)}};
}

// Fields that span decades start on a logarithmic colour scale; empty cells are no reason against it.
bool wants_log(const std::vector<float>& truth) {
  std::vector<float> positive;
  for (const float value : truth) {
    if (value < 0) return false;
    if (value > 0) positive.push_back(value);
  }
  if (2 * positive.size() < truth.size()) return false;
  std::sort(positive.begin(), positive.end());
  return positive[positive.size() - 1 - positive.size() / 200] > 100 * positive[positive.size() / 20];
}

Json embedded(const AccuracyReport& report) {
  const auto& figures = *report.figures;
  Json root{{"sequential", to_hex(sequential_map())}, {"diverging", to_hex(diverging_map())}};
  for (const auto& cut : figures.cuts) root["cuts"].push_back(pack_cut(cut));
  for (const auto m : figures.cut_methods)
    root["methods"].push_back(method_label(report.methods[m].file.name));
  for (std::size_t f = 0; f < report.fields.size(); ++f) {
    const auto unit = shown_unit(report.fields[f].info.name, report.fields[f].info.unit);
    Json field{{"name", report.fields[f].info.name},
               {"unit", unit.symbol},
               {"factor", unit.factor},
               {"log", wants_log(figures.fields[f].cuts.front().front())}};
    for (const auto& of_case : figures.fields[f].cuts) {
      Json series = Json::array();
      for (const auto& values : of_case) series.push_back(pack(values));
      field["cases"].push_back(std::move(series));
    }
    root["fields"].push_back(std::move(field));
  }
  return root;
}

std::string options(const std::vector<std::string>& names, std::size_t selected) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += fmt::format("<option value=\"{}\"{}>{}</option>", i, i == selected ? " selected" : "",
                        svg::escape(names[i]));
  return text;
}

}  // namespace

std::string cut_viewer(const AccuracyReport& report, const std::vector<CutPanel>& panels, bool with_choice) {
  std::vector<std::string> fields, cases, methods;
  std::size_t first = 0;
  for (std::size_t f = 0; f < report.fields.size(); ++f) {
    fields.push_back(field_label(report.fields[f].info.name));
    if (report.fields[f].info.name == "solid_volume_fraction") first = f;
  }
  for (const auto& scored : report.cases) cases.push_back(case_text(scored.name, scored.load));
  for (const auto m : report.figures->cut_methods) methods.push_back(report.title(m));
  const auto chosen =
      fmt::format("<label>predicted by<select id=\"cut-method\">{}</select></label>", options(methods, 0));
  std::string drawings;
  for (const auto& panel : panels)
    drawings += fmt::format("<figure><h3>{}</h3><canvas data-series=\"{}\"></canvas></figure>", panel.title,
                            panel.series);
  return fmt::format(
      "<div class=\"controls\"><label>field<select id=\"cut-field\">{}</select></label><label>held-out "
      "case<select id=\"cut-case\">{}</select></label>{}<label class=\"tick\"><input "
      "type=\"checkbox\" id=\"cut-log\">logarithmic colours</label></div>"
      "<div class=\"slices\">{}</div><p id=\"readout\">Point at a cell to read its values.</p>"
      "<noscript><p>The cuts are drawn by a script inside this page; it is switched off.</p></noscript>"
      "<script type=\"application/json\" id=\"cut-data\">{}</script>",
      options(fields, first), options(cases, 0), with_choice ? chosen : "", drawings,
      embedded(report).dump());
}

std::string cut_section(const AccuracyReport& report) {
  const auto truth = svg::escape(report.words.reference());
  return section("cuts", fmt::format("Vertical cuts: {}, prediction, difference", truth),
                 "Through the middle of the mesh, to scale. The first two share one colour scale, the 0.5 to "
                 "99.5 % range of the first.",
                 cut_viewer(report,
                            {{truth, "0"},
                             {"<span id=\"cut-method-name\">ELROM</span>", "chosen"},
                             {"predicted &minus; " + truth, "chosen-0"}},
                            true));
}

}  // namespace elrom::report
