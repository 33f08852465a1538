#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/networks/search.hpp"

namespace elrom::networks {
std::vector<double> log_bins(const std::vector<double>& range, double bins_a_decade) {
  const double decades = std::log10(range[1] / range[0]);
  const auto n = static_cast<std::size_t>(std::round(decades * bins_a_decade)) + 1;
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    const double fraction = n == 1 ? 0 : static_cast<double>(i) / static_cast<double>(n - 1);
    values.push_back(*base::to_double(base::rounded(range[0] * std::pow(range[1] / range[0], fraction), 3)));
  }
  return values;
}

std::vector<double> size_bins(const std::vector<double>& range, double factor) {
  std::vector<double> values;
  for (double value = range[0]; value < range[1] * 0.99; value *= factor) {
    values.push_back(value > 16 ? std::round(value / 8) * 8 : std::round(value));
  }
  values.push_back(std::round(range[1]));
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

std::vector<double> whole_bins(const std::vector<double>& range) {
  std::vector<double> values;
  for (double value = std::round(range[0]); value <= range[1]; ++value) values.push_back(value);
  return values;
}

std::vector<double> even_bins(const std::vector<double>& range, std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) {
    const double value =
        range[0] + (range[1] - range[0]) * static_cast<double>(i) / static_cast<double>(n - 1);
    values.push_back(*base::to_double(base::rounded(value, 3)));
  }
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

namespace {

std::vector<ValueSpace::Axis> searched(const SearchSettings& settings) {
  std::vector<ValueSpace::Axis> axes{{"learning_rate", log_bins(settings.learning_rate, 16)},
                                     {"n_layers", whole_bins(settings.n_layers)},
                                     {"n_units", size_bins(settings.n_units, std::sqrt(2.0))},
                                     {"batch_size", size_bins(settings.batch_size, 2.0)}};
  if (settings.regularise) {
    axes.push_back({"weight_decay", log_bins(settings.weight_decay, 3)});
    axes.push_back({"dropout", even_bins(settings.dropout, 7)});
  }
  return axes;
}

}  // namespace

ValueSpace::ValueSpace(NamedValues fixed, std::vector<Axis> axes) : fixed_(std::move(fixed)) {
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    const auto own = std::ranges::find(axes, fixed_[i].name, &Axis::name);
    if (own == axes.end()) continue;
    check(!own->values.empty() && !std::holds_alternative<std::string>(fixed_[i].value),
          "search space: values of a number");
    axes_.push_back(std::move(*own));
    places_.push_back(i);
  }
  check(axes_.size() == axes.size(), "search space: what is searched is a hyperparameter");
}

NamedValues ValueSpace::decode(std::span<const double> point) const {
  auto values = fixed_;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto n = axes_[i].values.size();
    const double x = std::isfinite(point[i]) ? std::clamp(point[i], 0.0, 1.0) : 0.5;
    const double chosen =
        axes_[i].values[std::min(n - 1, static_cast<std::size_t>(x * static_cast<double>(n)))];
    auto& value = values[places_[i]].value;
    if (std::holds_alternative<int>(value))
      value = static_cast<int>(chosen);
    else
      value = chosen;
  }
  return values;
}

std::vector<double> ValueSpace::initial_step() const {
  std::vector<double> step;
  for (const auto& axis : axes_)
    step.push_back(std::clamp(1.0 / static_cast<double>(axis.values.size()), 0.2, 0.5));
  return step;
}

SearchSpace::SearchSpace(const SearchSettings& settings, model::Activation activation)
    : SearchSpaceOf({.activation = activation}, searched(settings)) {}

}  // namespace elrom::networks
