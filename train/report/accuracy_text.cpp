// What a user reads in the terminal at the end of a run.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/text.hpp"
#include "elrom/report/accuracy.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

/// ANSI sequences, or nothing.
struct Ink {
  bool colour;
  [[nodiscard]] std::string paint(std::string_view code, const std::string& text) const {
    return colour ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
  }
  [[nodiscard]] std::string strong(const std::string& text) const { return paint("1", text); }
  [[nodiscard]] std::string good(const std::string& text) const { return paint("1;32", text); }
  [[nodiscard]] std::string faint(const std::string& text) const { return paint("2", text); }
};

constexpr std::size_t name_width = 24, narrow = 10;
constexpr std::string_view gain_heading = "   gain over the best peer";

// Wider where a method is marked.
std::size_t column_width(const AccuracyReport& report) {
  std::size_t longest = narrow - 2;
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    for (const auto& mark : report.marks(m)) longest = std::max(longest, mark.size());
  return longest + 2;
}

std::string rule(std::size_t width) {
  std::string line = "  ";
  for (std::size_t i = 0; i < name_width + width; ++i) line += "─";
  return line + '\n';
}

// Long labels take two lines: "POD + GP" over "per mode".
std::array<std::string, 2> heading_lines(const std::string& label) {
  constexpr std::size_t most = narrow - 1;
  if (label.size() <= most) return {"", label};
  const auto cut = label.rfind(' ', most);
  if (cut == std::string::npos) return {"", label.substr(0, most)};
  return {label.substr(0, cut), label.substr(cut + 1, most)};
}

std::size_t best_method(const std::vector<double>& scores) {
  std::size_t best = scores.size();
  for (std::size_t m = 0; m < scores.size(); ++m)
    if (std::isfinite(scores[m]) && (best == scores.size() || scores[m] < scores[best])) best = m;
  return best;
}

std::string row(const std::string& name, const std::vector<double>& scores, std::size_t width, const Ink& ink,
                const std::string& note = "") {
  const auto best = best_method(scores);
  auto line = fmt::format("  {:<{}}", name, name_width);
  for (std::size_t m = 0; m < scores.size(); ++m) {
    const auto text = fmt::format("{:>{}}", score_text(scores[m]) + (m == best ? "*" : " "), width);
    line += m == best ? ink.good(text) : text;
  }
  return line + (note.empty() ? "" : "   " + ink.faint(note)) + '\n';
}

std::string heading(const AccuracyReport& report, const Ink& ink) {
  std::array<std::string, 4> lines{"", fmt::format("  {:<{}}", "field", name_width), "", ""};
  for (auto& line : lines) line.resize(name_width + 2, ' ');
  const auto width = column_width(report);
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    const auto parts = heading_lines(method_label(report.methods[m].file.name));
    const auto marks = report.marks(m);
    for (std::size_t k = 0; k < lines.size(); ++k)
      lines[k] += fmt::format("{:>{}} ",
                              k < 2                  ? parts[k]
                              : k - 2 < marks.size() ? marks[k - 2]
                                                     : "",
                              width - 1);
  }
  lines[1] += report.best_peer() ? gain_heading : "";
  std::string text;
  for (const auto& line : lines)
    if (line.find_first_not_of(' ') != std::string::npos) text += ink.strong(line) + '\n';
  return text;
}

std::vector<double> field_scores(const AccuracyReport& report, const FieldAccuracy& field) {
  std::vector<double> scores;
  for (std::size_t m = 0; m < report.methods.size(); ++m) scores.push_back(field.nrmse(m));
  return scores;
}

std::string coverage_line(const AccuracyReport& report) {
  std::string line;
  for (std::size_t k = 0; k < coverage_levels.size(); ++k)
    if (const double share = report.mean_coverage(k); std::isfinite(share))
      line += fmt::format("{}{:.0f} % -> {:.1f} %", line.empty() ? "" : ", ", 100 * coverage_levels[k],
                          100 * share);
  return line.empty() ? "" : "  coverage promised -> measured: " + line + '\n';
}

std::string validity_line(const AccuracyReport& report) {
  std::string text;
  for (const auto& scored : report.cases)
    if (scored.validity.verdict != model::Verdict::inside)
      text += fmt::format("  {} lies {} of the trained cases: {}\n", scored.name,
                          scored.validity.verdict == model::Verdict::edge ? "at the edge" : "outside",
                          scored.validity.reason);
  return text;
}

std::string field_note(const AccuracyReport& report, const FieldAccuracy& field) {
  const auto& own = field.methods[0];
  auto note = report.best_peer() ? fmt::format("{:<22}", gain_text(report.gain(field))) : std::string();
  if (!own.kind.empty() && own.kind != report.methods[0].file.name)
    note += (note.empty() ? "by " : " by ") + method_label(own.kind);
  return note;
}

std::vector<double> averaged_errors(const AccuracyReport& report) {
  std::vector<double> errors;
  for (std::size_t m = 0; m < report.methods.size(); ++m) errors.push_back(report.averaged_error(m).value);
  return errors;
}

// What the noise of the truth leaves to say; nothing is claimed of an error that lies below it.
std::string noise_line(const AccuracyReport& report) {
  double floor = 0;
  for (const auto& field : report.fields)
    floor += field.noise_nrmse.value_or(0) / static_cast<double>(report.fields.size());
  auto text = fmt::format(
      "  The truth's own noise (repeated runs) is {} of it, about the least that any model can reach",
      score_text(floor));
  if (report.has_averaged_truth()) return text + ".\n";
  if (const double gain = report.gain_without_noise(); std::isfinite(gain))
    text += fmt::format("; with it taken off, ELROM is {} {} the best peer", percent_text(std::abs(gain)),
                        gain >= 0 ? "below" : "above");
  if (const auto below = report.fields_below_noise(); below > 0)
    text += fmt::format(
        ".\n  ELROM's error is below the measured noise in {} of {} fields, so no gain with noise taken off is "
        "claimed",
        below, report.fields.size());
  return text + ".\n";
}

}  // namespace

std::string terminal_table(const AccuracyReport& report, bool colour) {
  const Ink ink{colour};
  const auto width = column_width(report);
  auto text =
      "\n  " + ink.strong("Error on held-out cases") +
      ink.faint(fmt::format("   NRMSE: 0 is perfect, 1 is predicting the mean of the {} training cases",
                            report.n_training)) +
      "\n\n";
  const auto line = ink.faint(rule(width * report.methods.size()));
  text += heading(report, ink) + line;
  for (const auto& field : report.fields)
    text +=
        row(field_label(field.info.name), field_scores(report, field), width, ink, field_note(report, field));
  text += line;
  std::vector<double> means, clean;
  for (const auto& method : report.methods) {
    means.push_back(method.mean_nrmse);
    clean.push_back(method.mean_nrmse_without_noise);
  }
  text += row("mean", means, width, ink, report.best_peer() ? gain_text(report.gain()) : "");
  if (report.has_averaged_truth())
    text +=
        row("mean, averaged truths", averaged_errors(report), width, ink, gain_text(report.averaged_gain()));
  else if (const auto n = report.fields_above_noise(); n == report.fields.size())
    text += row("mean, noise taken off", clean, width, ink);
  else if (n > 0)
    text += row(fmt::format("{} of {}, noise taken off", n, report.fields.size()), clean, width, ink,
                "fields where no method is below the noise");
  text += "\n  " + ink.strong(headline(report)) + '\n';
  if (!report.repeats.empty()) text += noise_line(report);
  return text + coverage_line(report) + validity_line(report) + ink.faint("  * best in its row") +
         (report.best_peer()
              ? ink.faint(fmt::format("; gains with their {:.0f} % interval over the {} {}", 100 * gain_level,
                                      report.cases.size(), report.words.case_word(report.cases.size())))
              : "") +
         '\n';
}

}  // namespace elrom::report
