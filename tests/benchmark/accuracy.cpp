// bench-accuracy: does what a study promises hold when other cases take the held-out cases' place? Trains the
// shipped split and, for every further set, a split of its own with the same settings (elrom-train run),
// scores each (elrom-report accuracy), and prints the verdicts: fields at or below the best simple peer, mean
// against the best single peer, with and without the noise of the truth, promised against measured coverage.
//
// Every set is a share of the training cases, dealt out in order of load, so that it asks for loads all over
// the range as the held-out cases do; those join the training cases meanwhile.

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/statistics.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

constexpr double least_gain = 0.08, widest_gap = 0.05;  // what a study promises; a gap in coverage

struct Options : benchmark::StudyArguments {
  Names held_out{"load_*"}, repeats{"rep*"};
  int sets = 0;
};

struct Trial {
  std::string name;
  Names held_out;
};

bool matches_any(const std::string& name, const Names& patterns) {
  return std::ranges::any_of(patterns, [&](const auto& p) { return base::matches(name, p); });
}

std::vector<Trial> trials_of(const Options& options) {
  std::vector<Trial> trials{{"held out", options.held_out}};
  const auto store = field::SnapshotStore::open(options.store);
  std::vector<field::CaseInputs> cases;
  for (const auto& record : store.cases())
    if (!matches_any(record.inputs.name, options.held_out) &&
        !matches_any(record.inputs.name, options.repeats))
      cases.push_back(record.inputs);
  std::ranges::stable_sort(cases, {}, &field::CaseInputs::load);
  const auto n_sets = static_cast<std::size_t>(options.sets);
  for (std::size_t s = 0; s < n_sets; ++s) {
    Trial trial{fmt::format("set {}", s + 1), {}};
    for (std::size_t i = s; i < cases.size(); i += n_sets) trial.held_out.push_back(cases[i].name);
    trials.push_back(std::move(trial));
  }
  return trials;
}

/// The report of one trained trial.
Json report_of(const Trial& trial, const Options& options, const std::filesystem::path& folder) {
  Names patterns;
  for (const auto* names : {&trial.held_out, &options.repeats})
    for (const auto& name : *names) patterns.push_back("\"" + name + "\"");
  return benchmark::trained_report(options, folder / base::join(base::split(trial.name, ' '), "_"),
                                   options.store, {"split.held_out=[" + base::join(patterns, ", ") + "]"});
}

/// Sums of squares of one method in one field, which trials can be added in.
struct Sums {
  double error = 0, departure = 0;
  [[nodiscard]] double nrmse() const { return math::nrmse(error, departure, 0); }
};

/// One trial, or several scored together.
struct Score {
  Names fields, methods;  // the study's own first
  std::map<std::string, bool> is_peer;
  std::map<std::string, std::map<std::string, Sums>> sums;  // by field, method
  std::vector<double> promised, covered;                    // by level
  double gain_without_noise = 0, n_cases = 0;

  void add(const Json& report) {
    const auto n = static_cast<double>(report["cases"].size());
    if (fields.empty()) start(report);
    for (const auto& field : report["fields"])
      for (const auto& method : field["methods"]) {
        auto& sum = sums[field["field"]][method["method"]];
        const double error = std::pow(method["rmse"].get<double>(), 2) * method["cells"].get<double>();
        sum.error += error;
        sum.departure += error / std::pow(method["nrmse"].get<double>(), 2);
      }
    for (std::size_t k = 0; k < covered.size(); ++k)
      covered[k] += (report["coverage"][k]["measured"].get<double>() - covered[k]) * n / (n_cases + n);
    const auto& gain = report["gain_without_noise"];
    gain_without_noise +=
        ((gain.is_number() ? gain.get<double>() : NAN) - gain_without_noise) * n / (n_cases + n);
    n_cases += n;
  }

  [[nodiscard]] double mean(const std::string& method) const {
    double sum = 0;
    for (const auto& field : fields) sum += sums.at(field).at(method).nrmse();
    return sum / static_cast<double>(fields.size());
  }
  /// Lowest of the simple peers by `error`.
  template <class Error>
  [[nodiscard]] std::string best_peer(const Error& error) const {
    std::string best;
    for (const auto& method : methods)
      if (is_peer.at(method) && (best.empty() || error(method) < error(best))) best = method;
    return best;
  }
  [[nodiscard]] std::string best_peer_of(const std::string& field) const {
    return best_peer([&](const std::string& method) { return sums.at(field).at(method).nrmse(); });
  }

 private:
  void start(const Json& report) {
    for (const auto& field : report["fields"]) fields.push_back(field["field"]);
    for (const auto& method : report["methods"]) {
      methods.push_back(method["method"]);
      is_peer[methods.back()] = method["simple_peer"];
    }
    for (const auto& level : report["coverage"]) promised.push_back(level["promised"]);
    covered.assign(promised.size(), 0.0);
  }
};

void print_table(const std::string& title, const Score& score) {
  fmt::print("\n{:<24}", title);
  for (const auto& method : score.methods) fmt::print(" {:>15}", method);
  for (const auto& field : score.fields) {
    fmt::print("\n{:<24}", field);
    for (const auto& method : score.methods)
      fmt::print(" {:>15.4f}", score.sums.at(field).at(method).nrmse());
  }
  fmt::print("\n{:<24}", "mean");
  for (const auto& method : score.methods) fmt::print(" {:>15.4f}", score.mean(method));
  fmt::print("\n");
}

/// Prints what is promised and what was measured. @return the same as JSON
Json judge(const std::string& title, const Score& score) {
  const auto& own = score.methods.front();
  Names lost;
  for (const auto& field : score.fields) {
    const auto& of_field = score.sums.at(field);
    const auto best = score.best_peer_of(field);
    if (of_field.at(own).nrmse() > of_field.at(best).nrmse())
      lost.push_back(fmt::format("{} ({} {:.4f} against {:.4f})", field, best, of_field.at(best).nrmse(),
                                 of_field.at(own).nrmse()));
  }
  const auto single = score.best_peer([&](const std::string& method) { return score.mean(method); });
  const double gain = 1 - score.mean(own) / score.mean(single);
  double gap = 0;
  std::string coverage;
  for (std::size_t k = 0; k < score.promised.size(); ++k) {
    gap = std::max(gap, std::abs(score.covered[k] - score.promised[k]));
    coverage += fmt::format("{}{:.0f} -> {:.1f} %", k > 0 ? ", " : "", 100 * score.promised[k],
                            100 * score.covered[k]);
  }
  fmt::print("\n{}\n", title);
  const auto verdict = [](bool holds) { return holds ? "holds" : "FAILS"; };
  fmt::print("  {}  fields at or below the best peer: {} of {}{}{}\n", verdict(lost.empty()),
             score.fields.size() - lost.size(), score.fields.size(), lost.empty() ? "" : ", not ",
             base::join(lost, ", "));
  fmt::print(
      "  {}  mean {:.1f} % below the best single peer ({}); {:.1f} % with the truth's noise taken off\n",
      verdict(gain >= least_gain), 100 * gain, single, 100 * score.gain_without_noise);
  fmt::print("  {}  coverage {}\n", verdict(gap <= widest_gap), coverage);
  Json nrmse;
  for (const auto& field : score.fields)
    for (const auto& method : score.methods) nrmse[method][field] = score.sums.at(field).at(method).nrmse();
  return {{"cases", score.n_cases},
          {"nrmse", nrmse},
          {"mean_nrmse", score.mean(own)},
          {"best_single_peer", single},
          {"gain", gain},
          {"gain_without_noise", score.gain_without_noise},
          {"fields_lost", lost},
          {"promised", score.promised},
          {"covered", score.covered},
          {"holds", lost.empty() && gain >= least_gain && gap <= widest_gap}};
}

int run(const Options& options) {
  const test::TemporaryFolder temporary;
  const auto folder = options.folder.empty() ? temporary.path() : options.folder;
  Json json{{"effort", options.effort}, {"trials", Json::object()}};
  Score together;
  for (const auto& trial : trials_of(options)) {
    const Json report = report_of(trial, options, folder);
    Score score;
    score.add(report);
    json["trials"][trial.name] =
        judge(fmt::format("verdict of {}, {} cases", trial.name, report["cases"].size()), score);
    if (trial.name != "held out") together.add(report);
    std::fflush(stdout);
  }
  if (options.sets > 1) {
    print_table("all sets together", together);
    json["all sets"] = judge("verdict of all sets together", together);
  }
  if (!options.json.empty()) base::write_text(options.json, json.dump(1) + "\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-accuracy", [&] {
    Options options;
    benchmark::CommandLine line(
        "Whether ELROM is at or below every simple peer, and its intervals cover what they promise, on the "
        "held-out cases and on other sets of cases in their place (NRMSE; 1 = no skill).");
    options.add_to(line);
    line.add("--sets", options.sets, "further trials, each holding back a share of the training cases");
    line.add_list("--held-out", options.held_out, "names or patterns of the held-out cases");
    if (const auto status = line.parse(argc, argv)) return *status;
    options.store = std::filesystem::absolute(options.store);
    if (options.small)
      options.settings.insert(options.settings.end(),
                              {"fields.names=[\"pressure\", \"solid_velocity_z\"]", "peers.networks=false"});
    return run(options);
  });
}
