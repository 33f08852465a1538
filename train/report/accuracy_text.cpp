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

constexpr std::size_t name_width = 24, column_width = 10;

std::string rule(std::size_t n_columns) {
  std::string line = "  ";
  for (std::size_t i = 0; i < name_width + column_width * n_columns; ++i) line += "─";
  return line + '\n';
}

// Long labels take two lines: "POD + GP" over "per mode".
std::array<std::string, 2> heading_lines(const std::string& label) {
  constexpr std::size_t most = column_width - 1;
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

std::string row(const std::string& name, const std::vector<double>& scores, const Ink& ink,
                const std::string& note = "") {
  const auto best = best_method(scores);
  auto line = fmt::format("  {:<{}}", name, name_width);
  for (std::size_t m = 0; m < scores.size(); ++m) {
    const auto text = fmt::format("{:>{}}", score_text(scores[m]) + (m == best ? "*" : " "), column_width);
    line += m == best ? ink.good(text) : text;
  }
  return line + (note.empty() ? "" : "   " + ink.faint(note)) + '\n';
}

std::string heading(const AccuracyReport& report, const Ink& ink) {
  std::array<std::string, 2> lines{std::string(name_width + 2, ' '),
                                   fmt::format("  {:<{}}", "field", name_width)};
  for (const auto& method : report.methods) {
    const auto parts = heading_lines(method_label(method.file.name));
    for (std::size_t k = 0; k < 2; ++k) lines[k] += fmt::format("{:>{}} ", parts[k], column_width - 1);
  }
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

// Fields where a simple peer is better: with figures while they are few, by name otherwise.
std::string losses(const AccuracyReport& report) {
  constexpr std::size_t most_with_figures = 2;
  const std::size_t n_lost = report.fields.size() - report.fields_won();
  std::vector<std::string> lost;
  for (const auto& field : report.fields) {
    const auto best = report.best_peer(field);
    if (!best || field.nrmse(0) <= field.nrmse(*best)) continue;
    lost.push_back(field_label(field.info.name));
    if (n_lost <= most_with_figures)
      lost.back() += fmt::format(" ({} {} against {})", method_label(report.methods[*best].file.name),
                                 score_text(field.nrmse(*best)), score_text(field.nrmse(0)));
  }
  return base::join(lost, ", ");
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

}  // namespace

std::string headline(const AccuracyReport& report) {
  auto text =
      fmt::format("{} held-out {}: mean NRMSE {} over {} {}", report.cases.size(),
                  report.cases.size() == 1 ? "load" : "loads", score_text(report.methods.front().mean_nrmse),
                  report.fields.size(), report.fields.size() == 1 ? "field" : "fields");
  const auto best = report.best_peer();
  if (!best) return text + ", with no peer beside it.";
  const double gain = report.gain();
  text += fmt::format(", {} {} the best single peer ({}, {})", percent_text(std::abs(gain)),
                      gain >= 0 ? "below" : "above", method_label(report.methods[*best].file.name),
                      score_text(report.methods[*best].mean_nrmse));
  const auto lost = losses(report);
  return text + (lost.empty() ? "; no peer is better in any field." : "; a peer is better in " + lost + ".");
}

std::string terminal_table(const AccuracyReport& report, bool colour) {
  const Ink ink{colour};
  auto text =
      "\n  " + ink.strong("Error on held-out cases") +
      ink.faint(fmt::format("   NRMSE: 0 is perfect, 1 is predicting the mean of the {} training cases",
                            report.n_training)) +
      "\n\n";
  text += heading(report, ink) + ink.faint(rule(report.methods.size()));
  for (const auto& field : report.fields)
    text += row(field_label(field.info.name), field_scores(report, field), ink,
                field.methods[0].kind.empty() || field.methods[0].kind == report.methods[0].file.name
                    ? ""
                    : "by " + method_label(field.methods[0].kind));
  text += ink.faint(rule(report.methods.size()));
  std::vector<double> means, clean, times;
  for (const auto& method : report.methods) {
    means.push_back(method.mean_nrmse);
    clean.push_back(method.mean_nrmse_without_noise);
  }
  text += row("mean", means, ink);
  if (!report.repeats.empty()) text += row("mean, noise taken off", clean, ink);
  text += "\n  " + ink.strong(headline(report)) + '\n';
  if (!report.repeats.empty()) {
    double floor = 0;
    for (const auto& field : report.fields)
      floor += field.noise_nrmse.value_or(0) / static_cast<double>(report.fields.size());
    text +=
        fmt::format(
            "  The truth's own noise (repeated runs) is {} of it, about the least that any model can reach",
            score_text(floor)) +
        (std::isfinite(report.gain_without_noise())
             ? fmt::format("; with it taken off, ELROM is {} {} the best peer.\n",
                           percent_text(std::abs(report.gain_without_noise())),
                           report.gain_without_noise() >= 0 ? "below" : "above")
             : ".\n");
  }
  return text + coverage_line(report) + validity_line(report) + ink.faint("  * best in its row") + '\n';
}

}  // namespace elrom::report
