#include <algorithm>
#include <cmath>
#include <map>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/networks/search.hpp"

namespace elrom::networks {
namespace {

// From low to high, a fixed number of bins a decade, each
// value rounded to three digits so that its text is exact.
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

// low, then steps of about 1.41 rounded to whole numbers (multiples of 8 above 16), high.
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

// Values of each hyperparameter that is searched; the others stay what they are.
std::map<std::string_view, std::vector<double>> searched(const SearchSettings& settings) {
  std::map<std::string_view, std::vector<double>> values{
      {"learning_rate", log_bins(settings.learning_rate, 16)},
      {"n_layers", whole_bins(settings.n_layers)},
      {"n_units", size_bins(settings.n_units, std::sqrt(2.0))},
      {"batch_size", size_bins(settings.batch_size, 2.0)}};
  if (settings.regularise) {
    values["weight_decay"] = log_bins(settings.weight_decay, 3);
    values["dropout"] = even_bins(settings.dropout, 7);
  }
  return values;
}

}  // namespace

SearchSpace::SearchSpace(const SearchSettings& settings, model::Activation activation)
    : activation_(activation) {
  auto values = searched(settings);
  for (const auto* name : hyperparameter_names)
    if (const auto own = values.find(name); own != values.end())
      axes_.push_back({name, std::move(own->second)});
  check(axes_.size() == values.size(), "search space: what is searched is a hyperparameter");
}

Hyperparameters SearchSpace::decode(std::span<const double> point) const {
  Hyperparameters h;
  h.activation = activation_;
  std::size_t i = 0;
  for_each_hyperparameter(h, [&](std::string_view name, auto& value) {
    if (i == axes_.size() || axes_[i].name != name) return;
    const auto n = axes_[i].values.size();
    const double x = std::isfinite(point[i]) ? std::clamp(point[i], 0.0, 1.0) : 0.5;
    const double chosen =
        axes_[i].values[std::min(n - 1, static_cast<std::size_t>(x * static_cast<double>(n)))];
    value = static_cast<std::remove_reference_t<decltype(value)>>(chosen);
    ++i;
  });
  return h;
}

std::string SearchSpace::key(const Hyperparameters& h) {
  std::vector<std::string> parts;
  for_each_hyperparameter(h, [&](std::string_view, const auto& value) { parts.push_back(text_of(value)); });
  return base::join(parts, " ");
}

std::vector<double> SearchSpace::initial_step() const {
  std::vector<double> step;
  for (const auto& axis : axes_)
    step.push_back(std::clamp(1.0 / static_cast<double>(axis.values.size()), 0.2, 0.5));
  return step;
}

}  // namespace elrom::networks
