#include "svg.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace elrom::report::svg {
namespace {

// Two decimals are a hundredth of a pixel; whole numbers carry none.
std::string number(double value) {
  auto text = fmt::format("{:.1f}", value);
  if (text.ends_with(".0")) text.resize(text.size() - 2);
  return text == "-0" ? "0" : text;
}

std::string tip_element(std::string_view tip) {
  return tip.empty() ? std::string{} : fmt::format("<title>{}</title>", escape(tip));
}

}  // namespace

Chart::Chart(Size size, Axis x, Axis y, std::string title)
    : size_(size), x_(std::move(x)), y_(std::move(y)), title_(std::move(title)) {}

double Chart::px(double x) const {
  return size_.left + std::clamp(x_.fraction(x), -0.5, 1.5) * (size_.width - size_.left - size_.right);
}
double Chart::py(double y) const {
  return size_.height - size_.bottom -
         std::clamp(y_.fraction(y), -0.5, 1.5) * (size_.height - size_.top - size_.bottom);
}

void Chart::line(std::span<const double> x, std::span<const double> y, std::string_view css_class,
                 std::string_view name) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const bool drawable = std::isfinite(x_.fraction(x[i])) && std::isfinite(y_.fraction(y[i]));
    if (drawable) path += fmt::format("{}{} {}", pen_down ? "L" : "M", number(px(x[i])), number(py(y[i])));
    pen_down = drawable;
  }
  body_ += fmt::format("<path class=\"line {}\" d=\"{}\">{}</path>", css_class, path, tip_element(name));
}

void Chart::points(std::span<const double> x, std::span<const double> y, std::string_view css_class,
                   std::string_view name) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x_.fraction(x[i])) || !std::isfinite(y_.fraction(y[i]))) continue;
    const auto tip = fmt::format("{}: {}, {}", name, tick_label(x[i]), fmt::format("{:.4g}", y[i]));
    body_ += fmt::format("<circle class=\"point {}\" cx=\"{}\" cy=\"{}\" r=\"3.5\">{}</circle>", css_class,
                         number(px(x[i])), number(py(y[i])), tip_element(tip));
  }
}

void Chart::band(std::span<const double> x_low, std::span<const double> x_high, std::span<const double> y,
                 std::string_view css_class, std::string_view name) {
  std::string path;
  const auto add = [&](double x, double at) {
    path += fmt::format("{}{} {}", path.empty() ? "M" : "L",
                        number(std::clamp(px(x), size_.left, size_.width - size_.right)), number(py(at)));
  };
  for (std::size_t i = 0; i < y.size(); ++i)
    add(std::isfinite(x_.fraction(x_low[i])) ? x_low[i] : x_.low, y[i]);
  for (std::size_t i = y.size(); i-- > 0;)
    add(std::isfinite(x_.fraction(x_high[i])) ? x_high[i] : x_.low, y[i]);
  body_ += fmt::format("<path class=\"band {}\" d=\"{}Z\">{}</path>", css_class, path, tip_element(name));
}

void Chart::whisker(double x, double y_low, double y_high, std::string_view css_class) {
  body_ += fmt::format("<path class=\"line {}\" d=\"M{} {}V{}\"/>", css_class, number(px(x)),
                       number(py(y_low)), number(py(y_high)));
}

void Chart::box(double x_low, double x_high, double y_low, double y_high, std::string_view css_class,
                std::string_view tip, double opacity) {
  const double left = px(x_low), right = px(x_high), top = py(y_high), bottom = py(y_low);
  body_ += fmt::format("<rect class=\"fill {}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}>{}</rect>",
                       css_class, number(left), number(top), number(std::max(0.0, right - left)),
                       number(std::max(0.0, bottom - top)),
                       opacity < 1 ? fmt::format(" opacity=\"{:.3f}\"", opacity) : "", tip_element(tip));
}

void Chart::dots(std::span<const double> x, std::span<const double> y, std::string_view css_class,
                 std::string_view name) {
  std::string path;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (std::isfinite(x_.fraction(x[i])) && std::isfinite(y_.fraction(y[i])))
      path += fmt::format("M{} {}h0", number(px(x[i])), number(py(y[i])));
  body_ += fmt::format("<path class=\"dots {}\" d=\"{}\">{}</path>", css_class, path, tip_element(name));
}

void Chart::tile(double x_low, double x_high, double y_low, double y_high, std::string_view colour,
                 std::string_view tip) {
  const double left = px(x_low), top = py(y_high);
  body_ += fmt::format("<rect fill=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\">{}</rect>", colour,
                       number(left), number(top), number(std::max(0.0, px(x_high) - left)),
                       number(std::max(0.0, py(y_low) - top)), tip_element(tip));
}

void Chart::label(double x, double y, std::string_view text, std::string_view anchor) {
  const double shift = anchor == "end" ? -7 : anchor == "start" ? 7 : 0;
  body_ += fmt::format("<text class=\"label\" x=\"{}\" y=\"{}\" text-anchor=\"{}\">{}</text>",
                       number(px(x) + shift), number(py(y) + 4), anchor, escape(text));
}

std::string Chart::axes() const {
  const double right = size_.width - size_.right, bottom = size_.height - size_.bottom;
  const int n_x = std::max(2, static_cast<int>((right - size_.left) / 80));
  const int n_y = std::max(2, static_cast<int>((bottom - size_.top) / 50));
  std::string text;
  for (const double tick : ticks(x_, n_x))
    text += fmt::format(
        "<path class=\"grid\" d=\"M{0} {1}V{2}\"/><text class=\"tick\" x=\"{0}\" y=\"{3}\" "
        "text-anchor=\"middle\">{4}</text>",
        number(px(tick)), number(size_.top), number(bottom), number(bottom + 15), tick_label(tick));
  for (const double tick : ticks(y_, n_y))
    text += fmt::format(
        "<path class=\"grid\" d=\"M{0} {1}H{2}\"/><text class=\"tick\" x=\"{3}\" y=\"{4}\" "
        "text-anchor=\"end\">{5}</text>",
        number(size_.left), number(py(tick)), number(right), number(size_.left - 6), number(py(tick) + 4),
        tick_label(tick));
  text += fmt::format("<path class=\"frame\" d=\"M{0} {1}V{2}H{3}\"/>", number(size_.left), number(size_.top),
                      number(bottom), number(right));
  text += fmt::format("<text class=\"axis\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                      number(0.5 * (size_.left + right)), number(size_.height - 6), escape(x_.label));
  text += fmt::format(
      "<text class=\"axis\" transform=\"translate(13 {}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
      number(0.5 * (size_.top + bottom)), escape(y_.label));
  return text;
}

// A nested <svg> cuts its content off without an identifier, which a clip path would need.
std::string Chart::clipped_body() const {
  if (!size_.clip) return body_;
  const double width = size_.width - size_.left - size_.right,
               height = size_.height - size_.top - size_.bottom;
  return fmt::format(
      "<svg x=\"{0}\" y=\"{1}\" width=\"{2}\" height=\"{3}\" viewBox=\"{0} {1} {2} {3}\">{4}</svg>",
      number(size_.left), number(size_.top), number(width), number(height), body_);
}

std::string Chart::text() const {
  return fmt::format(
      "<svg class=\"chart\" viewBox=\"0 0 {0} {1}\" style=\"max-width:{0}px\" role=\"img\" "
      "aria-label=\"{2}\">{3}{4}</svg>",
      number(size_.width), number(size_.height), escape(title_), axes(), clipped_body());
}

std::string bars(const std::vector<BarRow>& rows, const std::string& axis_label, const std::string& title,
                 double width) {
  constexpr double row_height = 26, bar_height = 16, top = 6, bottom = 40, right = 120;
  const double left = 172;
  double longest = 0;
  for (const auto& row : rows) {
    double sum = 0;
    for (const auto& part : row.parts) sum += std::max(0.0, part.value);
    if (std::isfinite(sum)) longest = std::max(longest, sum);
  }
  const Axis axis{axis_label, 0, longest > 0 ? longest : 1, Scale::linear};
  const auto at = [&](double value) { return left + axis.fraction(value) * (width - left - right); };
  const double floor = top + row_height * static_cast<double>(rows.size());
  std::string body;
  for (const double tick : ticks(axis, 5))
    body += fmt::format(
        "<path class=\"grid\" d=\"M{0} {1}V{2}\"/><text class=\"tick\" x=\"{0}\" y=\"{3}\" "
        "text-anchor=\"middle\">{4}</text>",
        number(at(tick)), number(top), number(floor), number(floor + 15), tick_label(tick));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double y = top + row_height * static_cast<double>(i) + (row_height - bar_height) / 2;
    body += fmt::format("<text class=\"name\" x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
                        number(left - 8), number(y + 12), escape(rows[i].name));
    double sum = 0;
    for (const auto& part : rows[i].parts) {
      const double value = std::isfinite(part.value) ? std::max(0.0, part.value) : 0;
      body += fmt::format("<rect class=\"fill {}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\">{}</rect>",
                          part.css_class, number(at(sum)), number(y), number(at(sum + value) - at(sum)),
                          number(bar_height), tip_element(part.tip));
      sum += value;
    }
    body += fmt::format("<text class=\"label\" x=\"{}\" y=\"{}\">{}</text>", number(at(sum) + 7),
                        number(y + 12), escape(rows[i].note));
  }
  body += fmt::format(
      "<path class=\"frame\" d=\"M{0} {1}V{2}\"/><text class=\"axis\" x=\"{3}\" y=\"{4}\" "
      "text-anchor=\"middle\">{5}</text>",
      number(left), number(top), number(floor), number(0.5 * (left + width - right)), number(floor + 34),
      escape(axis_label));
  return fmt::format(
      "<svg class=\"chart\" viewBox=\"0 0 {0} {1}\" style=\"max-width:{0}px\" role=\"img\" "
      "aria-label=\"{2}\">{3}</svg>",
      number(width), number(floor + bottom), escape(title), body);
}

}  // namespace elrom::report::svg
