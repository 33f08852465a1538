// What a report says in words: how good, against what, how sure, and what is not like for like.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "elrom/base/text.hpp"
#include "elrom/report/accuracy.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

std::string better_text(const AccuracyReport& report, std::size_t method,
                        const std::vector<std::size_t>& fields, bool with_figures) {
  const auto name = method_label(report.methods[method].file.name);
  if (!with_figures) return fmt::format("{} ({} of {})", name, fields.size(), report.fields.size());
  std::vector<std::string> texts;
  for (const auto f : fields)
    texts.push_back(fmt::format("{} ({} {} against {})", field_label(report.fields[f].info.name), name,
                                score_text(report.fields[f].nrmse(method)),
                                score_text(report.fields[f].nrmse(0))));
  return base::join(texts, ", ");
}

// Fields where another method shown, simple peer or not, is better: with figures while they are few.
std::string losses(const AccuracyReport& report) {
  constexpr std::size_t most_with_figures = 2;
  std::map<std::size_t, std::vector<std::size_t>> better;
  std::size_t n = 0;
  for (std::size_t m = 1; m < report.methods.size(); ++m)
    if (auto fields = report.fields_better(m); !fields.empty()) {
      n += fields.size();
      better[m] = std::move(fields);
    }
  if (better.empty()) return "; no other method is better in any field.";
  std::vector<std::string> texts;
  for (const auto& [m, fields] : better)
    texts.push_back(better_text(report, m, fields, n <= most_with_figures));
  return (n <= most_with_figures ? "; another method is better in " : "; fields where another is better: ") +
         base::join(texts, ", ") + ".";
}

// "ELROM from 77 cases, linear, POD + RBF from 64"
std::string unlike(const AccuracyReport& report) {
  std::map<std::size_t, std::vector<std::string>, std::greater<>> by_size;
  bool any = false;
  for (const auto& method : report.methods) {
    any = any || method.other_cases;
    by_size[method.training_cases.size()].push_back(method_label(method.file.name));
  }
  if (!any) return "";
  std::vector<std::string> texts;
  for (const auto& [n, names] : by_size)
    texts.push_back(base::join(names, ", ") + fmt::format(" from {}", n));
  if (by_size.size() == 1) texts.back() += ", not all the same";
  return " Not like for like, by training cases: " + base::join(texts, "; ") + ".";
}

std::string leaks(const AccuracyReport& report) {
  constexpr std::size_t most_named = 4;
  std::string text;
  for (const auto& method : report.methods) {
    const auto& leaked = method.leaked_cases;
    if (leaked.empty()) continue;
    const auto shown = std::vector(
        leaked.begin(), leaked.begin() + static_cast<std::ptrdiff_t>(std::min(most_named, leaked.size())));
    text += fmt::format(
        " {} was trained on held-out {} ({}{}): its errors there are no test.",
        method_label(method.file.name), report.words.case_word(leaked.size()), base::join(shown, ", "),
        leaked.size() > most_named ? fmt::format(" and {} more", leaked.size() - most_named) : "");
  }
  return text;
}

// "each the mean of 5 runs"
std::string runs_text(const std::vector<std::size_t>& runs) {
  const auto [least, most] = std::ranges::minmax(runs);
  return least == most ? fmt::format("{} runs", least) : fmt::format("{} to {} runs", least, most);
}

std::string interval_text(const std::optional<math::LikelyRange>& interval) {
  if (!interval) return "too few cases for an interval";
  return fmt::format("{:.0f} % interval {:.3f} to {:.3f}", 100 * gain_level, interval->low, interval->high);
}

// Errors against the mean of several runs: what single runs hide in their own noise.
std::string averaged_headline(const AccuracyReport& report) {
  const auto own = report.averaged_error(0);
  auto text =
      fmt::format("Truths averaged over {} each, the noise left in them taken off: mean NRMSE {} ({})",
                  runs_text(report.runs), score_text(own.value), interval_text(own.interval));
  if (const auto best = report.best_averaged_peer()) {
    const auto gain = report.averaged_gain();
    text += fmt::format(", {} {} the best single peer, {} ({})", in_words(gain),
                        gain.value >= 0 ? "below" : "above", method_label(report.methods[*best].file.name),
                        score_text(report.averaged_error(*best).value));
  }
  return text + ". Against single runs: ";
}

}  // namespace

std::string headline(const AccuracyReport& report) {
  auto text = report.has_averaged_truth() ? averaged_headline(report) : std::string();
  text +=
      fmt::format("{} held-out {}: mean NRMSE {} over {} {}", report.cases.size(),
                  report.words.case_word(report.cases.size()), score_text(report.methods.front().mean_nrmse),
                  report.fields.size(), report.fields.size() == 1 ? "field" : "fields");
  const auto apart = unlike(report) + leaks(report);
  if (const auto best = report.best_peer()) {
    const auto gain = report.gain();
    text += fmt::format(", {} {} the best single peer, {} ({})", in_words(gain),
                        gain.value >= 0 ? "below" : "above", method_label(report.methods[*best].file.name),
                        score_text(report.methods[*best].mean_nrmse));
  } else {
    text += ", with no simple peer beside it";
  }
  return text + (report.methods.size() > 1 ? losses(report) : ".") + apart;
}

std::vector<std::string> AccuracyReport::marks(std::size_t method) const {
  std::vector<std::string> marks;
  const auto& summary = methods[method];
  if (summary.other_cases) marks.push_back(fmt::format("{} cases", summary.training_cases.size()));
  if (!summary.leaked_cases.empty())
    marks.push_back(fmt::format("saw {} held out", summary.leaked_cases.size()));
  return marks;
}

std::string AccuracyReport::title(std::size_t method) const {
  const auto all = marks(method);
  return method_label(methods[method].file.name) + (all.empty() ? "" : " (" + base::join(all, ", ") + ")");
}

}  // namespace elrom::report
