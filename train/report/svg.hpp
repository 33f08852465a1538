#pragma once
// Line, band, bar and point charts as inline SVG text. Colours and strokes come
// from the page's style sheet by class ("s0" ... the methods' series, "truth",
// "rule"), so one drawing serves the light and the dark page and print.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace elrom::report::svg {

enum class Scale { linear, log };

/// A quantity along one side of a chart.
struct Axis {
  std::string label;  ///< "solid_velocity_z [m/s]"
  double low = 0, high = 1;
  Scale scale = Scale::linear;
  [[nodiscard]] double fraction(double value) const;  ///< 0 at low, 1 at high
};

/// About `wanted` round numbers (1, 2 or 5 times a power of ten) in [low, high]; powers of ten on a log axis.
[[nodiscard]] std::vector<double> ticks(const Axis& axis, int wanted);
/// As short as the tick spacing allows: "0.25", "1e-4".
[[nodiscard]] std::string tick_label(double value);
/// An axis that holds all finite values with a little room; positive data over `log_decades` decades become a
/// log axis.
[[nodiscard]] Axis fit_axis(std::string label, std::span<const double> values,
                            std::optional<double> log_decades = {});
/// &, <, >, " made safe for text and attributes.
[[nodiscard]] std::string escape(std::string_view text);

struct Size {
  double width = 640, height = 320;
  double left = 56, right = 12, top = 10, bottom = 42;
  bool clip = false;  ///< cut drawings off at the frame
};

/// Draws in the order of the calls; values that are not finite break a line.
class Chart {
 public:
  Chart(Size size, Axis x, Axis y, std::string title);

  void line(std::span<const double> x, std::span<const double> y, std::string_view css_class,
            std::string_view name);
  void points(std::span<const double> x, std::span<const double> y, std::string_view css_class,
              std::string_view name);
  /// Area between x_low(y) and x_high(y), for profiles over height.
  void band(std::span<const double> x_low, std::span<const double> x_high, std::span<const double> y,
            std::string_view css_class, std::string_view name);
  /// Whiskers y_low ... y_high at x.
  void whisker(double x, double y_low, double y_high, std::string_view css_class);
  /// A filled rectangle in data coordinates.
  void box(double x_low, double x_high, double y_low, double y_high, std::string_view css_class,
           std::string_view tip, double opacity = 1);
  /// Many small dots of one class as a single path; values that are not finite are left out.
  void dots(std::span<const double> x, std::span<const double> y, std::string_view css_class,
            std::string_view name);
  /// A rectangle in data coordinates of a colour of its own, "#rrggbb".
  void tile(double x_low, double x_high, double y_low, double y_high, std::string_view colour,
            std::string_view tip);
  /// Text beside a data point.
  void label(double x, double y, std::string_view text, std::string_view anchor = "start");
  /// Whole <svg> element, with axes.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] double px(double x) const;
  [[nodiscard]] double py(double y) const;
  [[nodiscard]] std::string axes() const;
  [[nodiscard]] std::string clipped_body() const;

  Size size_;
  Axis x_, y_;
  std::string title_, body_;
};

/// Horizontal stacked bars, one row a name; parts carry a class each.
struct BarPart {
  double value = 0;
  std::string css_class, tip;
};
struct BarRow {
  std::string name;
  std::vector<BarPart> parts;
  std::string note;  ///< written after the bar
};
[[nodiscard]] std::string bars(const std::vector<BarRow>& rows, const std::string& axis_label,
                               const std::string& title, double width = 640);

}  // namespace elrom::report::svg
