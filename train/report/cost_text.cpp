// The cost report in words and as a table for a terminal.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/text.hpp"
#include "elrom/report/cost.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

std::string front_sentence(const CostReport& report) {
  std::vector<const CostPoint*> front;
  for (const auto& point : report.points)
    if (point.front) front.push_back(&point);
  std::ranges::sort(front, {}, &CostPoint::error);
  std::string text;
  for (const auto* point : front)
    text += fmt::format("{}{} ({} at {} of training, {:.1f} ms a prediction)", text.empty() ? "" : ", ",
                        point->name, score_text(point->error, 3), training_text(*point), point->predict_ms);
  return "Worth having, from the most accurate to the cheapest: " + text + ".";
}

/// "networks cost 210 s here and buy nothing (0.634 against 0.629): leave them out (peers.networks = false)"
std::string part_sentence(const PartCost& part, const CostReport& report) {
  const auto own = std::ranges::find(report.points, part.study, &CostPoint::name);
  const auto errors =
      std::isfinite(part.error) && own != report.points.end()
          ? fmt::format(" ({} against {})", score_text(part.error, 3), score_text(own->error, 3))
          : "";
  const auto cost = fmt::format("{} cost {} of processor time", method_label(part.method),
                                base::duration(part.processor_seconds));
  if (part.fields_used > 0)
    return fmt::format("{} and answer, alone or blended, for {} of {} fields{}.", cost, part.fields_used,
                       part.fields, errors);
  const auto out = part.method == "networks" ? ": leave them out (peers.networks = false)" : "";
  return fmt::format("{} here and buy nothing{}{}.", cost, errors, out);
}

/// "With fewer cases the kernel smoother errs 0.681 +- 0.010 with 8 cases (0.2 s of fitting), ..."
std::string size_sentence(const CostReport& report) {
  std::string text;
  for (const auto& point : report.points) {
    if (point.cases == 0 || point.name.find(": kernel, ") == std::string::npos) continue;
    text += fmt::format("{}{} with {} cases ({})", text.empty() ? "" : ", ", score_text(point.error, 3),
                        point.cases, training_text(point));
  }
  return "By the number of cases the kernel smoother errs, for its fit alone: " + text + ".";
}

std::string reference_sentence(const CostReport& report) {
  const auto& reference = report.reference;
  const auto& model = report.points.front();
  const double core_seconds = 3600 * reference.hours * reference.cores;
  std::string text = fmt::format("{} takes {:.3g} h on {:.0f} cores for one case", reference.name,
                                 reference.hours, reference.cores);
  text += fmt::format("; a prediction takes {:.1f} ms on one, {:.1g} times less", model.predict_ms,
                      core_seconds / (1e-3 * model.predict_ms));
  if (model.train_processor_seconds)
    text += fmt::format(", and the training {}, {:.2g} % of one case", training_text(model),
                        100 * *model.train_processor_seconds / core_seconds);
  return text + fmt::format(" (its {:.0f} training cases took {:.3g} core hours).", reference.n_cases,
                            reference.n_cases * reference.hours * reference.cores);
}

}  // namespace

std::string training_text(const CostPoint& point) {
  if (point.train_processor_seconds)
    return base::duration(*point.train_processor_seconds) +
           (point.train_spread_seconds > 0 ? " +- " + base::duration(point.train_spread_seconds) : "");
  return point.train_seconds ? base::duration(*point.train_seconds) + " (wall)" : "not kept";
}

std::string prediction_text(const CostPoint& point) {
  if (!std::isfinite(point.predict_ms)) return "not timed";
  return fmt::format("{:.1f} +- {:.1f} ms", point.predict_ms, point.predict_spread_ms);
}

std::vector<std::string> in_words(const CostReport& report) {
  if (report.points.empty()) return {};
  std::vector<std::string> words{front_sentence(report)};
  double all = 0;
  for (const auto& part : report.parts) all += part.processor_seconds;
  for (const auto& part : report.parts)
    if (part.fields > 0 && part.processor_seconds > 0.05 * all) words.push_back(part_sentence(part, report));
  if (std::ranges::any_of(report.points, [](const CostPoint& point) { return point.cases > 0; }))
    words.push_back(size_sentence(report));
  if (report.reference.hours > 0) words.push_back(reference_sentence(report));
  return words;
}

std::string terminal_table(const CostReport& report) {
  std::size_t width = 12;
  for (const auto& point : report.points) width = std::max(width, point.name.size());
  auto text = fmt::format("\n  {:<{}}  {:>15}  {:>9}  {:>16}  {:>17}\n", "what", width, "error", "change",
                          "training", "prediction");
  text += "  " + std::string(width + 65, '-') + '\n';
  for (const auto& point : report.points) {
    const double change = point.error / report.points.front().error - 1;
    const auto error = point.error_deviation > 0
                           ? fmt::format("{} +- {:.3f}", score_text(point.error, 4), point.error_deviation)
                           : score_text(point.error, 4);
    text += fmt::format("  {:<{}}  {:>15}  {:>9}  {:>16}  {:>17}{}\n", point.name, width, error,
                        &point == &report.points.front() ? "" : fmt::format("{:+.1f} %", 100 * change),
                        training_text(point), prediction_text(point), point.front ? "  *" : "");
  }
  text +=
      "\n  error: mean NRMSE over fields on the held-out cases, and its standard error over them; change: against\n"
      "  the first line; training: processor time; prediction: processor time of opening and one case, median and\n"
      "  spread of 7; * no other is at least as good in error, training and prediction, and better in one;\n  'N cases': the fit alone to so many, +- over three draws\n\n";
  for (const auto& sentence : in_words(report)) text += "  " + sentence + '\n';
  return text;
}

}  // namespace elrom::report
