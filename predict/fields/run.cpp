#include "elrom/fields/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <optional>

#include "elrom/base/app.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/large_array.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/io/csv.hpp"
#include "hdf_file.hpp"
#include "key_figures.hpp"
#include "opened.hpp"
#include "report_lines.hpp"
#include "summary.hpp"
#include "targets.hpp"

namespace elrom::fields {
namespace {

/// From this many cases on Ctrl-C is watched for; below, ending the process at once is clean enough (files
/// appear whole).
constexpr std::size_t long_table = 16;
/// From this many cases on verdicts are counted, not listed.
constexpr std::size_t counted_table = 100;

/// What one thread needs for one case at a time; reused, so that a long table runs in flat memory.
struct Desk {
  model::Predictor::Scratch scratch;
  base::LargeArray<float> values, half_width;    //!< as predicted
  std::vector<float> chosen, chosen_half_width;  //!< after region and averages
  PhysicsResult physics;
  std::string text;
  double compute = 0, write = 0;
};

/// What one run does with each of its cases. Thread rule:
/// predict() from any thread, each with a desk of its own.
class CaseRunner {
 public:
  CaseRunner(const Arguments& arguments, const Opened& opened)
      : arguments_(arguments),
        opened_(opened),
        targets_(arguments),
        lines_(n_cases(), arguments.to_standard_output() ? stderr : stdout),
        text_(n_cases(), stdout),
        results_(n_cases()) {
    if (!arguments.summary.empty() || !arguments.page.empty())
      figures_.emplace(opened.predictor, opened.frame.extent);
  }

  void predict(std::size_t i, Desk& desk, int n_threads);
  /// Summary, page and counts, after the last case.
  void finish() const;
  [[nodiscard]] std::size_t n_cases() const { return opened_.list.cases.size(); }
  [[nodiscard]] std::size_t n_with(model::Verdict verdict) const {
    return static_cast<std::size_t>(std::ranges::count(results_, verdict, &CaseResult::verdict));
  }

 private:
  /// Predicts the case into the desk, and begins its file meanwhile where threads are left for that.
  /// @return what is to be written
  model::Prediction compute(const field::CaseInputs& inputs, const model::Assessment& assessment,
                            HdfFile& hdf, Desk& desk, int n_threads) const;
  /// @return what is to be said of it, on lines of its own
  std::string write(std::size_t i, Format format, const model::Prediction& prediction, HdfFile& hdf,
                    Desk& desk);
  void write_text(std::size_t i, Format format, const Coordinates& coordinates,
                  const model::Prediction& prediction, Desk& desk);
  [[nodiscard]] bool is_left_out(const model::Assessment& assessment) const {
    return arguments_.strict && assessment.verdict == model::Verdict::outside;
  }
  [[nodiscard]] bool counts_only() const { return n_cases() >= counted_table && !arguments_.verbose; }

  const Arguments& arguments_;
  const Opened& opened_;
  const Targets targets_;
  ReportLines lines_;
  ReportLines text_;  //!< of several cases on standard output
  std::vector<CaseResult> results_;
  std::optional<KeyFigures> figures_;
  std::once_flag heading_;
  std::mutex hdf5_;  //!< the library is not thread-safe
};

/// Rows of a CSV text without its headings, each with the case's name before it.
std::string rows_of_case(std::string_view csv, const std::string& name) {
  std::string rows;
  const auto begin = name + ",";
  csv.remove_prefix(csv.find('\n') + 1);
  while (!csv.empty()) {
    const auto end = csv.find('\n') + 1;
    rows.append(begin).append(csv.substr(0, end));
    csv.remove_prefix(end);
  }
  if (!rows.empty()) rows.pop_back();  // a line break follows
  return rows;
}

model::Prediction CaseRunner::compute(const field::CaseInputs& inputs, const model::Assessment& assessment,
                                      HdfFile& hdf, Desk& desk, int n_threads) const {
  const auto& predictor = opened_.predictor;
  const auto& extent = opened_.frame.extent;
  desk.values.resize(predictor.size());
  if (opened_.frame.level) desk.half_width.resize(predictor.size());
  model::Prediction prediction{
      .inputs = &inputs, .assessment = &assessment, .values = desk.values, .half_width = desk.half_width};
  // A single case: its file is written while it is predicted. In a table every thread has a case of its own.
  // With --timing one after the other, as what runs side by side has no time of its own.
  const bool at_once = n_threads > 1 && arguments_.writes(Format::hdf) && !arguments_.timing;
  model::Predictor::Alongside alongside;
  if (at_once) alongside.first = [&] { hdf.begin(); };
  // As predicted is as written, unless something is still chosen, averaged or repaired.
  if (at_once && !opened_.physics && extent.as_predicted())
    alongside.ready = [&](std::size_t i_field) { hdf.offer_field(prediction, i_field); };
  predictor.predict(inputs.values, desk.values, desk.half_width, desk.scratch, n_threads, alongside);
  if (opened_.physics) {
    desk.physics = opened_.physics->apply(inputs, desk.values);
    if (desk.physics.audit) prediction.audit = &*desk.physics.audit;
    if (desk.physics.change) prediction.change = &*desk.physics.change;
  }
  const std::size_t n_fields = opened_.frame.fields.size();
  prediction.values = extent.choose(desk.values, n_fields, desk.chosen);
  prediction.half_width = extent.choose(desk.half_width, n_fields, desk.chosen_half_width);
  return prediction;
}

std::string CaseRunner::write(std::size_t i, Format format, const model::Prediction& prediction, HdfFile& hdf,
                              Desk& desk) {
  if (format == Format::openfoam)
    return opened_.onto->write_time_folder(opened_.frame, prediction,
                                           targets_.path(format, *prediction.inputs));
  if (format == Format::hdf) {
    hdf.finish(prediction);
  } else if (opened_.onto && format == Format::ip) {
    auto placed = opened_.onto->place(opened_.frame, prediction);
    auto there = prediction;
    there.values = placed.values;
    write_text(i, format, opened_.onto->coordinates(), there, desk);
    return std::move(placed.text);
  } else {
    write_text(i, format, *opened_.coordinates, prediction, desk);
  }
  return {};
}

void CaseRunner::write_text(std::size_t i, Format format, const Coordinates& coordinates,
                            const model::Prediction& prediction, Desk& desk) {
  desk.text.clear();
  info_of(format).write(opened_.frame, coordinates, prediction, desk.text);
  if (arguments_.to_standard_output() && n_cases() > 1) {
    std::call_once(
        heading_, [&] { write_to_standard_output("case," + desk.text.substr(0, desk.text.find('\n') + 1)); });
    text_.add(i, rows_of_case(desk.text, io::csv_cell(prediction.inputs->name)));
  } else if (arguments_.to_standard_output()) {
    write_to_standard_output(desk.text);
  } else {
    targets_.write(format, *prediction.inputs, desk.text);
  }
}

void CaseRunner::predict(std::size_t i, Desk& desk, int n_threads) {
  base::Stopwatch lap;
  const auto& inputs = opened_.list.cases[i];
  const auto assessment = opened_.predictor.guard().assess(inputs.values);
  auto& result = results_[i];
  result = {assessment.verdict, assessment.reason, assessment.distance, {}, {}};
  std::string line =
      fmt::format("{}: {}, {}", inputs.name, model::name_of(assessment.verdict), assessment.reason);
  if (is_left_out(assessment)) {
    text_.add(i, "");
    lines_.add(i, counts_only() ? "" : line + "; not written (--strict)");
    return;
  }
  HdfFile hdf(hdf5_, [&] {
    auto file = targets_.begin(Format::hdf, inputs);
    const auto path = file->temporary();
    return HdfFile::Begun{std::move(file), model::PredictionWriter(opened_.frame, inputs, assessment, path)};
  });
  const auto prediction = compute(inputs, assessment, hdf, desk, n_threads);
  if (desk.physics.audit) result.unusual_audit = desk.physics.audit->unusual;
  if (figures_) {
    auto figures = figures_->of(inputs, desk.values);
    result.figures = std::move(figures.values);
    result.unusual_audit = std::move(figures.unusual);
  }
  desk.compute += lap.lap();
  std::string said;
  for (const auto format : arguments_.formats) {
    said += write(i, format, prediction, hdf, desk);
    if (!arguments_.to_standard_output()) line += " -> " + targets_.path(format, inputs).string();
  }
  desk.write += lap.lap();
  line += said + desk.physics.text();
  lines_.add(i, counts_only() ? "" : std::move(line));
}

void CaseRunner::finish() const {
  std::FILE* stream = arguments_.to_standard_output() ? stderr : stdout;
  if (counts_only()) {
    fmt::print(stream, "{} cases: {} inside, {} edge, {} outside{}{} (--verbose: a line for each)\n",
               n_cases(), n_with(model::Verdict::inside), n_with(model::Verdict::edge),
               n_with(model::Verdict::outside), arguments_.to_standard_output() ? "" : " -> ",
               arguments_.to_standard_output() ? "" : arguments_.output);
  }
  const auto n_unusual =
      std::ranges::count_if(results_, [](const CaseResult& result) { return !result.unusual_audit.empty(); });
  if (n_unusual > 0)
    fmt::print(stderr, "warning: {} of {} cases: mass or pressure unlike the training cases'\n", n_unusual,
               n_cases());
  if (!figures_) return;
  const Summary summary{opened_.predictor.bundle().info().schema, opened_.list, figures_->names(), results_};
  if (const auto n = n_held_alone(summary); n > 0)
    fmt::print(
        stderr,
        "  {} of them only since the sweep moved its inputs and held the others at the base's values\n", n);
  const auto put = [&](const std::filesystem::path& path, const char* what, const auto& make) {
    if (path.empty()) return;
    base::write_text(path, make());
    fmt::print(stream, "{} -> {}\n", what, path.string());
  };
  put(arguments_.summary, "summary", [&] { return summary_table(summary); });
  put(arguments_.page, "curves", [&] {
    std::vector<std::size_t> curves;
    for (std::size_t i = 0; i < figures_->names().size(); ++i)
      if (figures_->is_curve(i)) curves.push_back(i);
    return curves_page(summary, curves);
  });
}

/// One case: its fields are shared out. A table: its cases are, each on one thread.
void predict_all(CaseRunner& runner, std::size_t n_cases, int n_threads, Timing& timing) {
  const bool table = n_cases > 1;
  std::vector<Desk> desks(table ? static_cast<std::size_t>(n_threads) : 1);
  if (table) {
    const auto stop = n_cases >= long_table ? base::interrupt_token() : std::stop_token();
    base::parallel_for(
        n_cases, n_threads,
        [&](std::size_t i, int worker) { runner.predict(i, desks[static_cast<std::size_t>(worker)], 1); },
        stop);
  } else {
    runner.predict(0, desks[0], n_threads);
  }
  for (const auto& desk : desks) {
    timing.compute += desk.compute;
    timing.write += desk.write;
  }
}

}  // namespace

int run(const Arguments& arguments) {
  base::Stopwatch whole;
  Timing timing;
  const int n_threads = arguments.n_threads > 0 ? arguments.n_threads : base::available_threads();
  const double cached = arguments.timing ? cached_share(arguments.bundle) : 0;
  const auto opened = open(arguments, n_threads, timing);
  Targets(arguments).prepare(arguments, opened.list.cases);
  CaseRunner runner(arguments, opened);
  const std::size_t n_cases = runner.n_cases();
  predict_all(runner, n_cases, n_threads, timing);
  runner.finish();
  timing.wall = whole.lap();
  if (arguments.timing) {
    fmt::print(stderr, "{}\nbundle {:.0f} % in the page cache before ({}), {}\n", timing.text(n_cases),
               100 * cached, cached > 0.99 ? "warm" : "cold", page_faults());
  }
  const auto n_outside = runner.n_with(model::Verdict::outside);
  if (n_outside > 0 && arguments.strict) {
    throw ValidityError(
        fmt::format("{} of {} cases outside the trained range were not written", n_outside, n_cases));
  }
  return 0;
}

}  // namespace elrom::fields
