#include "elrom/model/guard.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/math/statistics.hpp"
#include "model_parts.hpp"

namespace elrom::model {
namespace {

constexpr base::EnumNames<Verdict, 3> verdicts{
    "verdict", {{Verdict::inside, "inside"}, {Verdict::edge, "edge"}, {Verdict::outside, "outside"}}};
constexpr std::size_t n_nearest = 3;
constexpr double edge_margin = 0.1;       // trained widths between edge and outside
constexpr double outside_excess = 0.2;    // trained widths: beyond it a case is outside in any event
constexpr double edge_share = 0.01;       // of the training cases, by range and by distance: edge
constexpr double least_share = 0.05;      // what few cases cannot tell from chance is no edge
constexpr double edge_distance = 1.1;     // times the loneliest training case's distance: edge
constexpr double outside_distance = 1.5;  // the same: outside
constexpr double rounding = 1e-9;         // relative: unit conversions must not push a case out of range
constexpr double farthest_difference = 1e150;
constexpr double constant_scale = 1e-2;  // of its value: the unit of distance for an input that never changed

struct Range {
  double low = 0, high = 0;
  [[nodiscard]] double slack() const { return rounding * std::max({std::abs(low), std::abs(high), 1e-30}); }
  /// How far `value` lies outside, in trained widths; 0 inside.
  [[nodiscard]] double excess(double value) const {
    const double over = std::max(low - value, value - high);
    if (over <= slack()) return 0;
    return high > low ? over / (high - low) : std::numeric_limits<double>::infinity();
  }
};

/// Standard deviation over the training cases, the unit of distance in one input.
double scale_of(const MatrixD& inputs, std::size_t input) {
  const auto column = inputs.col(static_cast<Eigen::Index>(input)).array();
  const double mean = column.mean();
  const double deviation = std::sqrt((column - mean).square().mean());
  return deviation > rounding * std::abs(mean) ? deviation : std::max(constant_scale * std::abs(mean), 1e-12);
}

Eigen::RowVectorXd scales_of(const MatrixD& inputs) {
  Eigen::RowVectorXd scales(inputs.cols());
  for (Eigen::Index i = 0; i < inputs.cols(); ++i) scales[i] = scale_of(inputs, static_cast<std::size_t>(i));
  return scales;
}

/// Root mean square of standardised differences to every training case.
std::vector<double> distances(const MatrixD& inputs, const Eigen::RowVectorXd& scales,
                              const Eigen::RowVectorXd& point) {
  std::vector<double> result(static_cast<std::size_t>(inputs.rows()));
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    // Beyond farthest_difference squares overflow; such a point is outside by any measure.
    const auto difference = ((inputs.row(i) - point).array() / scales.array())
                                .max(-farthest_difference)
                                .min(farthest_difference)
                                .eval();
    result[static_cast<std::size_t>(i)] = std::sqrt(difference.square().mean());
  }
  return result;
}

std::vector<std::size_t> nearest_first(const std::vector<double>& distances, std::size_t n) {
  std::vector<std::size_t> order(distances.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  n = std::min(n, order.size());
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(n), order.end(),
      [&](std::size_t a, std::size_t b) { return std::pair(distances[a], a) < std::pair(distances[b], b); });
  order.resize(n);
  return order;
}

/// Joint distance: the mean over the nearest few, steadier than the nearest alone.
double joint_distance(const std::vector<double>& distances, const std::vector<std::size_t>& nearest) {
  double sum = 0;
  for (const auto i : nearest) sum += distances[i];
  return nearest.empty() ? 0 : sum / static_cast<double>(nearest.size());
}

/// "primary_air 225 kg/s (trained 150 to 212, 21 % of that width outside)"
std::string range_text(const field::InputInfo& info, double value, const Range& range) {
  const auto& unit = base::unit(info.display_unit.empty() ? info.unit : info.display_unit);
  const auto show = [&](double si) { return base::rounded(unit.from_si(si)); };
  const auto width = std::isfinite(range.excess(value))
                         ? ", " + base::rounded(100 * range.excess(value), 2) + " % of that width outside"
                         : std::string();
  return info.name + " " + show(value) + " " + unit.symbol + " (trained " + show(range.low) + " to " +
         show(range.high) + width + ")";
}

/// ' and 2 other inputs'
std::string and_others(std::size_t n) {
  if (n < 2) return "";
  return " and " + std::to_string(n - 1) + (n == 2 ? " other input" : " other inputs");
}

std::string range_reason(const Assessment& assessment, std::string_view how) {
  const auto n = assessment.out_of_range.size();
  return assessment.out_of_range.front() + and_others(n) + (n > 1 ? " lie " : " lies ") + std::string(how) +
         " the trained range";
}

/// What the verdict rests on. @param range that an input's range alone makes it
std::string reason_text(const Assessment& assessment, Verdict range, double loneliest) {
  if (range == Verdict::outside) return range_reason(assessment, "outside");
  if (!assessment.unusual.empty()) {
    const auto more = assessment.unusual.size() - 1;
    return assessment.unusual.front() +
           (more > 0 ? " (and " + std::to_string(more) + " more such)" : std::string());
  }
  if (range == Verdict::edge) return range_reason(assessment, "just outside");
  if (assessment.verdict == Verdict::inside) {
    return (assessment.out_of_range.empty() ? "every input is in its trained range"
                                            : range_reason(assessment, "no farther outside") +
                                                  " than training cases lie outside the others'") +
           " and the case is as near to training cases as they are to each other";
  }
  const std::string distance = base::rounded(assessment.distance, 3);
  return "each input is in its trained range, but their combination is unusual: distance " + distance +
         " to the nearest training cases (the loneliest of them: " + base::rounded(loneliest, 3) + ")";
}

}  // namespace

std::string_view name_of(Verdict verdict) { return verdicts.name(verdict); }

Guard::Guard(const field::InputSchema& schema, const MatrixD& inputs, std::vector<std::string> names,
             std::vector<double> loads)
    : schema_(schema), inputs_(inputs), names_(std::move(names)), loads_(std::move(loads)) {
  const auto n = static_cast<std::size_t>(inputs_.rows());
  check(names_.size() == n && loads_.size() == n, "guard: one name and one load a case");
  check(static_cast<std::size_t>(inputs_.cols()) == schema_.size(), "guard: one column an input");
  if (n == 0 || !inputs_.allFinite())
    throw InputError("the guard needs finite inputs of at least one training case");
  learn_inputs();
  const auto scales = scales_of(inputs_);
  for (std::size_t i = 0; n > 1 && i < n; ++i) {
    auto others = distances(inputs_, scales, inputs_.row(static_cast<Eigen::Index>(i)));
    others[i] = std::numeric_limits<double>::infinity();
    self_distance_.push_back(joint_distance(others, nearest_first(others, std::min(n_nearest, n - 1))));
  }
  std::sort(self_distance_.begin(), self_distance_.end());
}

void Guard::learn_inputs() {
  std::vector<double> excess(static_cast<std::size_t>(inputs_.rows()), 0.0);
  for (Eigen::Index i = 0; i < inputs_.cols(); ++i) {
    std::vector<double> values(inputs_.col(i).begin(), inputs_.col(i).end());
    std::ranges::sort(values);
    low_.push_back(values.front());
    high_.push_back(values.back());
    // Without its case, an end of the range is the next value; ties leave it where it is.
    const auto n = values.size();
    if (n < 3) continue;
    for (Eigen::Index k = 0; k < inputs_.rows(); ++k) {
      const double value = inputs_(k, i);
      const Range others{value == values[0] ? values[1] : values[0],
                         value == values[n - 1] ? values[n - 2] : values[n - 1]};
      auto& worst = excess[static_cast<std::size_t>(k)];
      worst = std::max(worst, others.excess(value));
    }
  }
  const double rare = std::min(math::conformal_quantile(excess, 1 - edge_share), std::ranges::max(excess));
  const bool enough = 1 / (static_cast<double>(excess.size()) + 1) < least_share;
  edge_excess_ = enough ? std::min(rare, outside_excess) : 0;
  const auto n_flagged = std::ranges::count_if(excess, [&](double one) { return one > edge_excess_; });
  line_ = OperatingLine(inputs_, static_cast<std::size_t>(n_flagged));
}

void Guard::hold(std::span<const double> inputs, std::span<double> held) const {
  check(inputs.size() == low_.size() && held.size() == inputs.size(), "guard: one value an input");
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double width = high_[i] - low_[i];
    const double reach = width > 0 ? width : constant_scale * std::max(std::abs(low_[i]), 1e-12);
    held[i] = std::clamp(inputs[i], low_[i] - reach, high_[i] + reach);
  }
}

Assessment Guard::assess(std::span<const double> inputs) const {
  check(inputs.size() == schema_.size() && inputs_.rows() > 0, "guard: one value an input");
  const Eigen::Map<const Eigen::RowVectorXd> point(inputs.data(), static_cast<Eigen::Index>(inputs.size()));
  if (!point.allFinite()) throw NumericalError("an input of the case is not a finite number");
  Assessment result;
  const auto by_range = judge_ranges(inputs, result.out_of_range);
  const auto by_line = judge_line(inputs, result.unusual);
  const auto all = distances(inputs_, scales_of(inputs_), point);
  const auto nearest = nearest_first(all, n_nearest);
  for (const auto i : nearest) result.nearest.push_back({names_[i], loads_[i], all[i]});
  result.distance = joint_distance(all, nearest);
  result.verdict = std::max({by_range, by_line, judge_distance(result)});
  result.reason = reason_text(result, by_range, self_distance_.empty() ? 0 : self_distance_.back());
  return result;
}

Verdict Guard::judge_ranges(std::span<const double> inputs, std::vector<std::string>& out_of_range) const {
  std::vector<std::pair<double, std::string>> found;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Range range{low_[i], high_[i]};
    const double excess = range.excess(inputs[i]);
    if (excess > 0) found.emplace_back(-excess, range_text(schema_[i], inputs[i], range));
  }
  std::ranges::sort(found);
  const double worst = found.empty() ? 0 : -found.front().first;
  for (auto& [excess, text] : found) out_of_range.push_back(std::move(text));
  return worst > std::min(edge_excess_ + edge_margin, outside_excess) ? Verdict::outside
         : worst > edge_excess_                                       ? Verdict::edge
                                                                      : Verdict::inside;
}

Verdict Guard::judge_line(std::span<const double> inputs, std::vector<std::string>& unusual) const {
  const auto usual = line_.usual(inputs);
  std::vector<std::pair<double, std::string>> found;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const double distance = usual[i].distance(inputs[i]);
    if (distance > line_.limit())
      found.emplace_back(-distance, unusual_text(schema_[i], inputs[i], usual[i]));
  }
  std::ranges::sort(found);
  for (auto& [distance, text] : found) unusual.push_back(std::move(text));
  if (found.empty()) return Verdict::inside;
  return -found.front().first > line_.far_limit() ? Verdict::outside : Verdict::edge;
}

Verdict Guard::judge_distance(Assessment& result) const {
  if (self_distance_.empty()) return Verdict::inside;
  const auto first_as_far = std::lower_bound(self_distance_.begin(), self_distance_.end(), result.distance);
  const auto n_as_far = static_cast<double>(self_distance_.end() - first_as_far);
  const double n = static_cast<double>(self_distance_.size());
  result.p_value = (n_as_far + 1) / (n + 1);
  if (result.distance > outside_distance * self_distance_.back()) return Verdict::outside;
  const bool rare = result.p_value < least_share && n_as_far < std::max(1.0, edge_share * n);
  return rare && result.distance > edge_distance * self_distance_.back() ? Verdict::edge : Verdict::inside;
}

void Guard::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"cases", names_}}.dump());
  file.set(prefix + "/inputs", io::Tensor::copy(inputs_));
  file.set(prefix + "/loads", io::Tensor::copy(std::span(loads_), {loads_.size()}));
  file.set(prefix + "/self_distance", io::Tensor::copy(std::span(self_distance_), {self_distance_.size()}));
}

Guard Guard::load(const io::TensorFile& file, const std::string& prefix, const field::InputSchema& schema) {
  const auto description = parse_json(file.text(prefix), false);
  const std::string where = file.where() + ":" + prefix;
  if (!description.is_object() || !description.value("cases", nlohmann::json()).is_array()) {
    throw InputError(
        {.what = "no description of a guard", .where = where, .expected = "a JSON object with \"cases\""});
  }
  Guard guard;
  guard.schema_ = schema;
  for (const auto& name : description["cases"])
    guard.names_.push_back(name.is_string() ? name.get<std::string>() : "?");
  const std::size_t n = guard.names_.size();
  const std::size_t inputs_shape[] = {n, schema.size()}, loads_shape[] = {n}, any[] = {io::any_size};
  guard.inputs_ = file.tensor(prefix + "/inputs", inputs_shape).matrix64();
  const auto loads = file.tensor(prefix + "/loads", loads_shape).f64();
  const auto self = file.tensor(prefix + "/self_distance", any).f64();
  guard.loads_.assign(loads.begin(), loads.end());
  guard.self_distance_.assign(self.begin(), self.end());
  if (n == 0 || !guard.inputs_.allFinite() || !std::is_sorted(self.begin(), self.end())) {
    throw InputError(
        {.what = "broken guard", .where = where, .expected = "finite inputs of at least one training case"});
  }
  guard.learn_inputs();
  return guard;
}

}  // namespace elrom::model
