// bench-kernel: what each part of the kernel method buys, judged by training cases alone. Rows differ from
// the first in one option.
//
// Cases that the kernel has not seen: with --learn N it learns from the first N training cases and is judged
// by the others, otherwise by ten folds, each of every tenth case by load. Error: NRMSE, mean of the fields;
// behind it the change of the squared error against the first row, in percent, its mean over the fields and
// the standard error of that over the cases. Seconds are those of all fits.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/study.hpp"
#include "support/benchmark.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::ordered_json;
using Rows = std::vector<std::size_t>;

struct Options : benchmark::Arguments {
  std::vector<std::string> fields, variants;
  int learn = 0;
};

struct Variant {
  std::string name, what;
  methods::KernelOptions options;
};

std::vector<Variant> variants() {
  std::vector<Variant> all;
  const auto add = [&](const std::string& name, const std::string& what, const auto& change) {
    methods::KernelOptions options;
    change(options);
    all.push_back({name, what, options});
  };
  add("kernel", "as it is", [](auto&) {});
  add("one_zone", "one smoother for all heights", [](auto& o) { o.zones = 1; });
  add("two_zones", "two zones of height", [](auto& o) { o.zones = 2; });
  add("five_zones", "five zones of height", [](auto& o) { o.zones = 5; });
  add("no_scale", "the field itself, not over a scale", [](auto& o) { o.scale = false; });
  add("no_own_modes", "no mode has lengths and noise of its own", [](auto& o) { o.own_modes = 0; });
  add("two_own_modes", "two modes a zone have", [](auto& o) { o.own_modes = 2; });
  add("eight_own_modes", "eight modes a zone have", [](auto& o) { o.own_modes = 8; });
  add("fewer_modes", "modes that are left out hold twice as much", [](auto& o) { o.dropped *= 2; });
  add("few_modes", "five times as much", [](auto& o) { o.dropped *= 5; });
  add("no_shrinkage", "all wavelengths and cells are trusted", [](auto& o) { o.shrink = false; });
  add("one_pass", "errors not weighted by trust", [](auto& o) { o.passes = 1; });
  add("symmetric", "no antisymmetric part", [](auto& o) { o.antisymmetric = false; });
  return all;
}

/// What a variant makes of a field: squared errors by case, (n judged).
struct Outcome {
  std::vector<double> squares;
  double nrmse = 0, seconds = 0;
};

class Workbench {
 public:
  explicit Workbench(const Options& options)
      : options_(options), store_(field::SnapshotStore::open(options.store)) {
    const auto used = study::read_settings({}, {});
    rows_ = study::hold_out(store_, study::held_out_patterns(store_, used, silent_log())).building;
    cases_ = study::study_cases(store_, used, rows_, silent_log());
    const auto n_learned = static_cast<std::size_t>(options.learn);
    for (std::size_t i = 0; i < rows_.size(); ++i)
      (n_learned > 0 && i < n_learned ? learned_ : judged_).push_back(i);
    if (judged_.empty() || (n_learned > 0 && learned_.size() < 3))
      throw UsageError({.what = "--learn takes at least 3 cases and leaves one",
                        .found = std::to_string(options.learn),
                        .expected = "less than " + std::to_string(rows_.size())});
  }

  Json run() {
    std::vector<std::vector<Outcome>> outcomes;  // of each variant, by field
    std::vector<Variant> asked;
    for (auto& variant : variants()) {
      const bool named = options_.variants.empty() || asked.empty() ||
                         std::ranges::count(options_.variants, variant.name) > 0;
      if (named) asked.push_back(std::move(variant));
    }
    outcomes.resize(asked.size());
    Json fields = Json::array();
    for (const auto& info : store_.fields()) {
      if (!wanted(info.name)) continue;
      data_ = {&cases_, info, store_.read(info.name, rows_)};
      Json row{{"field", info.name}};
      std::string text = fmt::format("{:<24}", info.name);
      for (std::size_t v = 0; v < asked.size(); ++v) {
        outcomes[v].push_back(measure(asked[v].options));
        const auto [change, deviation] = change_of(outcomes[0].back(), outcomes[v].back());
        text += fmt::format("  {} {:.4f} ({:+.2f} %)", asked[v].name, outcomes[v].back().nrmse, 100 * change);
        row[asked[v].name] = {{"nrmse", outcomes[v].back().nrmse}, {"change", change}};
      }
      fmt::print("{}\n", text);
      std::fflush(stdout);
      fields.push_back(std::move(row));
    }
    Json table = Json::array();
    fmt::print("\n{:<16} {:>7} {:>9} {:>7} {:>8}  {}\n", "variant", "NRMSE", "change %", "+-", "seconds",
               "what");
    for (std::size_t v = 0; v < asked.size(); ++v)
      table.push_back(report(asked[v], outcomes[0], outcomes[v]));
    return {{"training_cases", rows_.size()},
            {"learned", learned_.size()},
            {"judged", judged_.size()},
            {"variants", std::move(table)},
            {"fields", std::move(fields)}};
  }

 private:
  [[nodiscard]] bool wanted(const std::string& field) const {
    if (!options_.fields.empty()) return std::ranges::count(options_.fields, field) > 0;
    return !options_.small || field == "pressure" || field == "solid_volume_fraction";
  }

  [[nodiscard]] Outcome measure(const methods::KernelOptions& options) const {
    const auto method = methods::make_kernel_method(options);
    const methods::FitContext context{
        .seed = base::Seed(1), .n_threads = options_.threads, .stop = base::interrupt_token()};
    const benchmark::Stopwatch watch;
    methods::Folds folds = methods::spread_folds(cases_, judged_, options_.small ? 4 : 10);
    MatrixF predicted;
    if (learned_.empty()) {
      predicted = method->cross_predict(data_, folds, context);
    } else {
      predicted.resize(data_.values.rows(), data_.values.cols());
      const auto model = method->fit(data_, learned_, context);
      model::Workspace workspace;
      for (const auto row : judged_) {
        const auto i = static_cast<Eigen::Index>(row);
        methods::predict_case(
            *model, {cases_.inputs.row(i).data(), cases_.schema.size()}, cases_.mesh.n_planes,
            {predicted.row(i).data(), static_cast<std::size_t>(predicted.cols())}, workspace);
      }
    }
    Outcome outcome{.seconds = watch.seconds()};
    const auto mean = math::column_moments(data_.values, learned_.empty() ? judged_ : learned_).mean;
    double variation = 0;
    for (const auto row : judged_) {
      const auto i = static_cast<Eigen::Index>(row);
      outcome.squares.push_back((data_.values.row(i) - predicted.row(i)).cast<double>().squaredNorm());
      variation += (data_.values.row(i).cast<double>() - mean.transpose()).squaredNorm();
    }
    outcome.nrmse =
        math::nrmse(std::accumulate(outcome.squares.begin(), outcome.squares.end(), 0.0), variation);
    return outcome;
  }

  struct Change {
    double mean = 0, deviation = 0;
  };
  /// Of the squared error as a share of the first one's, and the standard error of that over the cases.
  [[nodiscard]] static Change change_of(const Outcome& first, const Outcome& other) {
    const double total = std::accumulate(first.squares.begin(), first.squares.end(), 0.0);
    math::RunningMoments changes;
    for (std::size_t i = 0; i < first.squares.size(); ++i)
      changes.add((other.squares[i] - first.squares[i]) / total);
    const auto n = static_cast<double>(first.squares.size());
    return {n * changes.mean(), std::sqrt(n) * changes.deviation()};
  }

  [[nodiscard]] static Json report(const Variant& variant, const std::vector<Outcome>& first,
                                   const std::vector<Outcome>& own) {
    const auto n = static_cast<double>(own.size());
    double nrmse = 0, seconds = 0;
    // Cases are the same in all fields, so their changes are averaged over the fields first.
    Outcome mean_first{.squares = std::vector<double>(own.front().squares.size())}, mean_own = mean_first;
    for (std::size_t f = 0; f < own.size(); ++f) {
      nrmse += own[f].nrmse / n;
      seconds += own[f].seconds;
      const double total = std::accumulate(first[f].squares.begin(), first[f].squares.end(), 0.0);
      for (std::size_t i = 0; i < own[f].squares.size(); ++i) {
        mean_first.squares[i] += first[f].squares[i] / total;
        mean_own.squares[i] += own[f].squares[i] / total;
      }
    }
    const auto [change, deviation] = change_of(mean_first, mean_own);
    fmt::print("{:<16} {:>7.4f} {:>+9.2f} {:>7.2f} {:>8.1f}  {}\n", variant.name, nrmse, 100 * change,
               100 * deviation, seconds, variant.what);
    std::fflush(stdout);
    return {{"name", variant.name}, {"what", variant.what},        {"nrmse", nrmse},
            {"change", change},     {"standard_error", deviation}, {"seconds", seconds}};
  }

  const Options& options_;
  field::SnapshotStore store_;
  field::CaseSet cases_;
  Rows rows_;              // of the store, in the order of cases_
  Rows learned_, judged_;  // of cases_
  field::FieldData data_;  // the field at work
};

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-kernel", [&] {
    base::keep_freed_memory();  // as elrom-train does
    Options options;
    benchmark::CommandLine line("What each part of the kernel method buys, judged by training cases alone.");
    options.add_to(line, "snapshot store", benchmark::CommandLine::Need::required);
    line.add("--learn", options.learn, "learn from the first N training cases, judge by the others");
    line.add_list("--fields", options.fields, "fields, separated by commas [default: all]");
    line.add_list("--options", options.variants, "rows beside the first, separated by commas [default: all]");
    if (const auto status = line.parse(argc, argv)) return *status;
    Workbench workbench(options);
    return benchmark::show(workbench.run(), options.small, options.json);
  });
}
