// Sections of the page that come from other commands: learning curve, cost and the search's history.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "elrom/base/text.hpp"
#include "names.hpp"
#include "page_parts.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

using svg::escape;

double training_of(const CostPoint& point) {
  return point.train_processor_seconds.value_or(point.train_seconds.value_or(std::nan("")));
}

/// The points that none beats in these two: times ascending, errors falling.
void draw_front(svg::Chart& chart, const std::vector<double>& times, const std::vector<double>& errors) {
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return times[i]; });
  std::vector<double> x, y;
  for (const auto i : order) {
    if (!std::isfinite(times[i]) || !std::isfinite(errors[i]) || (!y.empty() && errors[i] >= y.back()))
      continue;
    x.push_back(times[i]);
    y.push_back(errors[i]);
  }
  if (x.size() > 1) chart.line(x, y, "s0", "front");
}

/// @param reference what the solver takes on this axis; NaN: nothing to compare with
std::string cost_chart(const CostReport& cost, const std::string& label,
                       const std::function<double(const CostPoint&)>& time, double reference) {
  std::vector<double> times, errors;
  for (const auto& point : cost.points) {
    times.push_back(time(point));
    errors.push_back(point.error);
  }
  if (std::none_of(times.begin(), times.end(), [](double t) { return std::isfinite(t); }))
    return "<p class=\"lead\">not kept</p>";
  auto all_times = times, all_errors = errors;
  const bool compared = std::isfinite(reference) && cost.reference.error > 0;
  if (compared) {
    all_times.push_back(reference);
    all_errors.push_back(cost.reference.error);
  }
  svg::Chart chart({.width = 540, .height = 340, .right = 110}, svg::fit_axis(label, all_times, 1.0),
                   svg::fit_axis("mean NRMSE", all_errors, 1.0), "Error against " + label);
  draw_front(chart, times, errors);
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || !std::isfinite(errors[i])) continue;
    const auto& point = cost.points[i];
    chart.points(std::span(&times[i], 1), std::span(&errors[i], 1), point.front ? "s0" : "s1", point.name);
    if (point.cases > 0) continue;  // named when pointed at: there are many
    const auto colon = point.name.rfind(": ");
    chart.label(times[i], errors[i],
                method_label(colon == std::string::npos ? point.name : point.name.substr(colon + 2)));
  }
  if (compared) {
    chart.points(std::span(&reference, 1), std::span(&cost.reference.error, 1), "s2", cost.reference.name);
    chart.label(reference, cost.reference.error, cost.reference.name);
  }
  return chart.text();
}

// Best value so far over the distinct trials of one search.
std::string history_chart(const networks::TrialStore::Search& search) {
  std::vector<double> number, value, best;
  for (const auto& trial : search.trials) {
    if (trial.i_seed != 0 || trial.diverged) continue;
    number.push_back(static_cast<double>(number.size() + 1));
    value.push_back(trial.value);
    const double finished = trial.pruned ? std::numeric_limits<double>::infinity() : trial.value;
    best.push_back(std::min(best.empty() ? finished : best.back(), finished));
  }
  if (number.size() < 2) return "";
  svg::Chart chart({.width = 330, .height = 230, .left = 60}, svg::fit_axis("trial", number),
                   svg::fit_axis("validation MSE", value, 1.0), "History of " + search.name);
  chart.points(number, value, "s1", "trial");
  chart.line(number, best, "s0", "best so far");
  return figure(search.name, chart.text());
}

struct Dimension {
  std::string name;
  double (*value)(const networks::Hyperparameters&);
};
const std::vector<Dimension>& dimensions() {
  static const std::vector<Dimension> all{
      {"learning rate", [](const networks::Hyperparameters& h) { return h.learning_rate; }},
      {"layers", [](const networks::Hyperparameters& h) { return double(h.n_layers); }},
      {"units", [](const networks::Hyperparameters& h) { return double(h.n_units); }},
      {"batch size", [](const networks::Hyperparameters& h) { return double(h.batch_size); }},
      {"weight decay", [](const networks::Hyperparameters& h) { return h.weight_decay; }},
      {"dropout", [](const networks::Hyperparameters& h) { return h.dropout; }}};
  return all;
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> rank(values.size());
  for (std::size_t i = 0; i < order.size();) {
    std::size_t end = i + 1;
    while (end < order.size() && values[order[end]] == values[order[i]]) ++end;
    for (std::size_t k = i; k < end; ++k)
      rank[order[k]] = 0.5 * static_cast<double>(i + end - 1);  // ties share their mean rank
    i = end;
  }
  return rank;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  const double mean_a = std::accumulate(a.begin(), a.end(), 0.0) / n,
               mean_b = std::accumulate(b.begin(), b.end(), 0.0) / n;
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    ab += (a[i] - mean_a) * (b[i] - mean_b);
    aa += (a[i] - mean_a) * (a[i] - mean_a);
    bb += (b[i] - mean_b) * (b[i] - mean_b);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : 0;
}

// Importance of a hyperparameter: absolute rank correlation
// (Spearman) with the error, averaged over the searches.
std::string importance_chart(const std::vector<networks::TrialStore::Search>& searches) {
  std::vector<svg::BarRow> rows;
  for (const auto& dimension : dimensions()) {
    double sum = 0;
    int n = 0;
    for (const auto& search : searches) {
      std::vector<double> x, y;
      for (const auto& trial : search.trials)
        if (trial.i_seed == 0 && !trial.diverged) {
          x.push_back(dimension.value(trial.hyperparameters));
          y.push_back(trial.value);
        }
      if (x.size() < 4 || *std::min_element(x.begin(), x.end()) == *std::max_element(x.begin(), x.end()))
        continue;
      sum += std::abs(correlation(ranks(x), ranks(y)));
      ++n;
    }
    if (n > 0) rows.push_back({dimension.name, {{sum / n, "s0", dimension.name}}, score_text(sum / n, 2)});
  }
  return rows.empty() ? ""
                      : svg::bars(rows, "mean absolute rank correlation with the validation error",
                                  "Importance of hyperparameters", 640);
}

// Every trial at its value of one hyperparameter. Searches differ in how hard their columns are, so an error
// counts in units of the best of its search.
std::string slice_chart(const Dimension& dimension,
                        const std::vector<networks::TrialStore::Search>& searches) {
  std::vector<double> x, y;
  for (const auto& search : searches) {
    double best = std::numeric_limits<double>::infinity();
    for (const auto& trial : search.trials)
      if (!trial.pruned && !trial.diverged) best = std::min(best, trial.value);
    for (const auto& trial : search.trials) {
      if (trial.i_seed != 0 || trial.diverged || !(best > 0) || !std::isfinite(best)) continue;
      x.push_back(dimension.value(trial.hyperparameters));
      y.push_back(trial.value / best);
    }
  }
  if (x.empty() || *std::min_element(x.begin(), x.end()) == *std::max_element(x.begin(), x.end())) return "";
  svg::Chart chart({.width = 330, .height = 230, .left = 60}, svg::fit_axis(dimension.name, x, 0.7),
                   svg::fit_axis("error / best of its search", y, 0.5), "Slice: " + dimension.name);
  chart.points(x, y, "s0", dimension.name + ", error / best");
  return figure(dimension.name, chart.text());
}

// Both ways to a lower error over what they cost, in hours or in cases' worth of computing.
std::string purchase_figures(const LearningCurve& curve) {
  if (!curve.has_averaged_truth() || curve.averaging.fields.empty())
    return "<p>What longer averaging would buy is not known: it is told by repeated runs of every held-out case, "
           "and by elrom-report learning-curve.</p>";
  const auto n = static_cast<double>(curve.v2.cases);
  const double unit = curve.price.hours > 0 ? curve.price.hours : 1;
  std::vector<double> spent, more, longer;
  for (double factor = 1; factor <= 4; factor += 0.05) {
    spent.push_back((factor - 1) * n * unit);
    more.push_back(curve.averaged_fit.at(factor * n));
    const double averaging = unit - curve.price.start_up;
    longer.push_back(curve.averaging.at(1 + (factor - 1) * unit / averaging));
  }
  auto reach = more;
  reach.insert(reach.end(), longer.begin(), longer.end());
  svg::Chart chart({.width = 640, .height = 340},
                   svg::fit_axis(curve.price.hours > 0 ? "further hours of " + curve.price.name
                                                       : std::string("further computing, in cases"),
                                 spent),
                   svg::fit_axis("mean NRMSE, averaged truths", reach), "More cases or longer averaging");
  if (!curve.averaged_fit.at_bound()) chart.line(spent, more, "s0", "more cases");
  chart.line(spent, longer, "s1", "each case averaged longer");
  return figure("More cases (blue), or each averaged longer (grey)", chart.text()) + "<pre>" +
         escape(purchase_table(curve)) + "</pre>";
}

}  // namespace

std::string learning_section(const LearningCurve& curve) {
  std::vector<double> cases, errors, reach;
  for (const auto& point : curve.points) {
    cases.push_back(static_cast<double>(point.cases));
    errors.push_back(point.error_mean);
    reach.push_back(point.error_mean + point.error_std);
    reach.push_back(point.error_mean - point.error_std);
  }
  std::vector<double> x, y;
  const double farthest =
      cases.back() + (curve.fit.at_bound() ? 0 : 40);  // a fit at its bound goes no further
  for (double n = cases.front(); n <= farthest; n += 1) {
    x.push_back(n);
    y.push_back(curve.fit.at(n));
  }
  reach.insert(reach.end(), y.begin(), y.end());
  svg::Chart chart({.width = 640, .height = 340}, svg::fit_axis("training cases", x),
                   svg::fit_axis("mean NRMSE over fields", reach), "Learning curve");
  chart.line(x, y, "rule", "fitted power law");
  for (std::size_t i = 0; i < cases.size(); ++i)
    chart.whisker(cases[i], errors[i] - curve.points[i].error_std, errors[i] + curve.points[i].error_std,
                  "s0");
  chart.line(cases, errors, "s0", "measured");
  chart.points(cases, errors, "s0", "training cases, error");
  std::string body;
  for (const auto& field : in_usual_order(curve.v2.field_error)) {
    const double v1 = curve.v1.field_error.at(field), v2 = curve.v2.field_error.at(field);
    body += fmt::format("<tr><th>{}</th><td>{}</td><td>{}</td><td>{:+.1f} %</td></tr>",
                        escape(field_label(field)), score_text(v1), score_text(v2), 100 * (v2 / v1 - 1));
  }
  body +=
      fmt::format("<tr class=\"sum\"><th>mean over fields</th><td>{}</td><td>{}</td><td>{:+.1f} %</td></tr>",
                  score_text(curve.v1.error_mean), score_text(curve.v2.error_mean),
                  100 * (curve.v2.error_mean / curve.v1.error_mean - 1));
  const auto table = fmt::format(
      "<figure><figcaption>The source's comparison: v1 (a third of the cases) and v2 (all)</figcaption><div "
      "class=\"scroll\"><table><thead><tr><th>field</th><th>v1, {} cases</th><th>v2, {} "
      "cases</th><th>change</th></tr></thead><tbody>{}</tbody></table></div></figure>",
      curve.v1.cases, curve.v2.cases, body);
  return section("learning", "What more cases and longer averaging buy",
                 fmt::format("{} fitted anew on nested subsets, scored on the same held-out cases. {}",
                             escape(method_label(curve.method)), outlook(curve)),
                 "<div class=\"grid2\">" +
                     figure("Error against the number of training cases", chart.text()) + table + "</div>" +
                     purchase_figures(curve));
}

std::string cost_section(const CostReport& cost) {
  std::string body, words;
  for (const auto& sentence : in_words(cost)) words += "<li>" + escape(sentence) + "</li>";
  for (const auto& point : cost.points)
    body += fmt::format(
        "<tr><td>{}</td><td>{} &plusmn; {:.3f}</td><td>{}</td><td>{}</td><td "
        "style=\"text-align:left\">{}</td></tr>",
        escape(point.name), score_text(point.error, 4), point.error_deviation, training_text(point),
        prediction_text(point), point.front ? "on the front" : "");
  const double core_seconds = 3600 * cost.reference.hours * cost.reference.cores;
  const double none = std::nan("");
  return section(
      "cost", "What accuracy costs in time",
      "Processor time, so that a busy machine does not change it. Blue: no other is at least as good in error, "
      "training and prediction time, and better in one; the line joins what none beats in the two that are drawn. "
      "The solver's error is the scatter of one run about the mean of repeated ones.",
      "<ul>" + words + "</ul><div class=\"grid2\">" +
          figure("Training; the solver: all training cases",
                 cost_chart(cost, "training [s]", training_of,
                            core_seconds > 0 ? core_seconds * cost.reference.n_cases : none)) +
          figure("One prediction; the solver: one case",
                 cost_chart(
                     cost, "one prediction [ms]", [](const CostPoint& p) { return p.predict_ms; },
                     core_seconds > 0 ? 1e3 * core_seconds : none)) +
          "</div><div class=\"scroll\"><table><thead><tr><th>what</th><th>mean "
          "NRMSE</th><th>training</th><th>one prediction</th><th></th></tr></thead><tbody>" +
          body + "</tbody></table></div>");
}

std::string search_section(const std::vector<networks::TrialStore::Search>& searches) {
  constexpr std::size_t most_shown = 12;
  std::string charts;
  std::size_t n_trials = 0;
  for (std::size_t i = 0; i < searches.size(); ++i) {
    n_trials += searches[i].trials.size();
    if (i < most_shown) charts += history_chart(searches[i]);
  }
  std::string slices;
  for (const auto& dimension : dimensions()) slices += slice_chart(dimension, searches);
  const auto grid = [](const std::string& figures) {
    return "<div class=\"grid3\" style=\"margin-top:18px\">" + figures + "</div>";
  };
  return section(
      "search", "Search for hyperparameters",
      fmt::format(
          "{} trials in {}. First what matters, then every trial at its value of each "
          "hyperparameter, then the history of {}.",
          n_trials, searches.size() == 1 ? "one search" : fmt::format("{} searches", searches.size()),
          searches.size() > most_shown ? fmt::format("the first {} searches", most_shown) : "every search"),
      importance_chart(searches) + grid(slices) + grid(charts));
}

}  // namespace elrom::report
