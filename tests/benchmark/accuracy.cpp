// bench-accuracy: error of every method on cases that it has not seen, field by field; first the held-out
// cases, then pseudo-held-out sets taken from the training cases (every set spans the loads), and the
// coverage of 90 % intervals.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/uncertainty.hpp"
#include "elrom/study/auto_method.hpp"
#include "elrom/study/cross_validation.hpp"
#include "elrom/study/kernel_method.hpp"
#include "elrom/study/peers.hpp"
#include "elrom/study/settings.hpp"

namespace {

using namespace elrom;
using Rows = std::vector<std::size_t>;

struct Options {
  std::string store, json;
  std::vector<std::string> held_out{"load_*"}, ignored{"rep*"}, methods;
  std::vector<std::string> fields;
  std::size_t sets = 0;  // pseudo-held-out sets
  int threads = base::available_threads();
  bool small = false, no_mirrors = false;
};

/// Who learns and who is asked.
struct Trial {
  std::string name;
  Rows building, asked;
};

struct Outcome {
  double error = 0, departure = 0;  // sums of squares over cases and cells
  double covered = 0, seconds = 0;
};

bool matches_any(const std::string& name, const std::vector<std::string>& patterns) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const auto& p) { return base::matches(name, p); });
}

std::vector<Trial> trials_of(const study::CaseSet& cases, const Options& options) {
  Trial held{"held out", {}, {}};
  for (std::size_t i = 0; i < cases.n_cases(); ++i) {
    if (matches_any(cases.names[i], options.ignored)) continue;
    (matches_any(cases.names[i], options.held_out) ? held.asked : held.building).push_back(i);
  }
  if (held.asked.empty()) throw UsageError("no case of the store is held out by --held-out");
  std::vector<Trial> trials{held};
  if (options.sets == 0) return trials;
  // Cases in order of load dealt out in turn: each set asks for loads all over the range, like the held-out
  // cases.
  Rows order = held.building;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return cases.loads[a] < cases.loads[b]; });
  for (std::size_t s = 0; s < options.sets; ++s) {
    Trial trial{fmt::format("set {}", s), {}, {}};
    for (std::size_t i = 0; i < order.size(); ++i) {
      (i % options.sets == s ? trial.asked : trial.building).push_back(order[i]);
    }
    trials.push_back(std::move(trial));
  }
  return trials;
}

/// The method by name; "auto" is fitted separately.
std::unique_ptr<study::Method> method_of(const std::string& name) {
  return name == "kernel" ? study::make_kernel_method() : study::make_peer(name);
}

struct Fitted {
  std::unique_ptr<model::FieldModel> model;
  MatrixF residuals;  // cross-validated; empty: no intervals
};

Fitted fit(const std::string& name, const study::FieldData& data, const Rows& building,
           const study::FitContext& context) {
  std::vector<std::unique_ptr<study::Method>> methods;
  if (name == "auto") {
    for (const auto& own : {"kernel", "linear", "pod_gp", "pod_gp_per_mode", "pod_rbf"})
      methods.push_back(method_of(own));
  } else if (name == "kernel") {
    methods.push_back(method_of(name));
  } else {
    return {method_of(name)->fit(data, building, context), {}};
  }
  std::vector<const study::Method*> candidates;
  for (const auto& method : methods) candidates.push_back(method.get());
  study::AutoFit fitted = study::fit_auto(data, building, candidates, {}, context);
  std::string weights;
  for (const auto& c : fitted.candidates)
    weights += fmt::format(" {} {:.4f} w {:.2f};", c.name, c.nrmse, c.weight);
  if (name == "auto") fmt::print("    {}: {:.4f} from{}\n", data.info.name, fitted.nrmse, weights);
  return {std::move(fitted.model), std::move(fitted.residuals)};
}

Outcome measure(const std::string& name, const study::FieldData& data, const Trial& trial,
                const study::FitContext& context) {
  const auto start = std::chrono::steady_clock::now();
  const Fitted fitted = fit(name, data, trial.building, context);
  Outcome outcome;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const Eigen::VectorXd mean = math::row_mean(data.values, trial.building, context.n_threads);
  const std::size_t n_cells = data.cases->mesh.n_cells();
  std::vector<float> values(n_cells), half(n_cells, 0.0F);
  if (fitted.residuals.size() != 0) {
    const model::Uncertainty uncertainty(fitted.residuals, data.cases->mesh.n_columns);
    std::vector<std::int32_t> planes(data.cases->mesh.n_planes);
    for (std::size_t p = 0; p < planes.size(); ++p) planes[p] = static_cast<std::int32_t>(p);
    uncertainty.scale(planes, half);
    for (float& h : half) h *= static_cast<float>(uncertainty.quantile(0.9));
  }
  model::Workspace workspace;
  for (std::size_t row : trial.asked) {
    const auto i = static_cast<Eigen::Index>(row);
    const auto inputs =
        std::span(data.cases->inputs.row(i).data(), static_cast<std::size_t>(data.cases->inputs.cols()));
    study::predict_case(*fitted.model, inputs, data.cases->mesh.n_planes, values, workspace);
    for (std::size_t c = 0; c < n_cells; ++c) {
      const double truth = data.values(i, static_cast<Eigen::Index>(c)), off = values[c] - truth;
      outcome.error += off * off;
      outcome.departure += std::pow(truth - mean[static_cast<Eigen::Index>(c)], 2);
      outcome.covered +=
          std::abs(off) <= half[c] ? 1.0 / static_cast<double>(n_cells * trial.asked.size()) : 0;
    }
  }
  return outcome;
}

using Table = std::map<std::string, std::vector<Outcome>>;  // by method: one entry a field

double nrmse(const Outcome& o) { return o.departure > 0 ? std::sqrt(o.error / o.departure) : 0; }

nlohmann::json print_table(const std::string& title, const Table& table, const Options& options,
                           const std::vector<std::string>& fields) {
  nlohmann::json json;
  fmt::print("\n{:<24}", title);
  for (const auto& m : options.methods) fmt::print(" {:>15}", m);
  fmt::print("\n");
  for (std::size_t f = 0; f < fields.size(); ++f) {
    fmt::print("{:<24}", fields[f]);
    for (const auto& m : options.methods) {
      const Outcome& o = table.at(m)[f];
      json[m][fields[f]] = {{"nrmse", nrmse(o)}, {"coverage_90", o.covered}, {"seconds", o.seconds}};
      fmt::print("  {:.4f} {}", nrmse(o), o.covered > 0 ? fmt::format("({:.3f})", o.covered) : "       ");
    }
    fmt::print("\n");
  }
  fmt::print("{:<24}", "mean, seconds");
  for (const auto& m : options.methods) {
    double mean = 0, seconds = 0;
    for (const Outcome& o : table.at(m)) {
      mean += nrmse(o) / static_cast<double>(fields.size());
      seconds += o.seconds;
    }
    json[m]["mean"] = mean;
    fmt::print("  {:.4f} {:>6.1f}s", mean, seconds);
  }
  fmt::print("\n");
  return json;
}

study::CaseSet case_set(const field::SnapshotStore& store, bool mirrors) {
  study::CaseSet cases{.mesh = store.mesh(), .schema = store.schema()};
  for (const auto& record : store.cases()) {
    cases.names.push_back(record.inputs.name);
    cases.loads.push_back(record.inputs.load);
  }
  cases.inputs = store.inputs(math::all_rows(store.n_cases()));
  if (!mirrors) return cases;
  for (const auto& declaration : study::furnace_mirrors()) {
    cases.mirrors.push_back(field::resolve(declaration, cases.schema, cases.mesh));
  }
  return cases;
}

int run(const Options& options) {
  const field::SnapshotStore store = field::SnapshotStore::open(options.store);
  const study::CaseSet cases = case_set(store, !options.no_mirrors);
  const std::vector<Trial> trials = trials_of(cases, options);
  std::vector<std::string> fields;
  for (const auto& info : store.fields()) {
    if (options.fields.empty() || matches_any(info.name, options.fields)) fields.push_back(info.name);
  }
  std::vector<Table> tables(trials.size());
  const study::FitContext context{.seed = base::Seed(1), .n_threads = options.threads};
  for (const auto& info : store.fields()) {
    if (std::find(fields.begin(), fields.end(), info.name) == fields.end()) continue;
    const study::FieldData data{&cases, info, store.read(info.name, math::all_rows(store.n_cases()))};
    for (std::size_t t = 0; t < trials.size(); ++t) {
      for (const auto& method : options.methods)
        tables[t][method].push_back(measure(method, data, trials[t], context));
    }
  }
  nlohmann::json json;
  Table pooled;
  for (std::size_t t = 0; t < trials.size(); ++t) {
    json[trials[t].name] = print_table(trials[t].name, tables[t], options, fields);
    if (t == 0) continue;
    for (const auto& [method, outcomes] : tables[t]) {
      auto& sums = pooled[method];
      sums.resize(outcomes.size());
      for (std::size_t f = 0; f < outcomes.size(); ++f) {
        sums[f].error += outcomes[f].error;
        sums[f].departure += outcomes[f].departure;
        sums[f].covered += outcomes[f].covered / static_cast<double>(trials.size() - 1);
        sums[f].seconds += outcomes[f].seconds;
      }
    }
  }
  if (!pooled.empty()) json["all sets"] = print_table("all sets", pooled, options, fields);
  if (!options.json.empty()) base::write_text(options.json, json.dump(1) + "\n");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.methods = study::peer_names();
  options.methods.insert(options.methods.end(), {"kernel", "auto"});
  CLI::App app(
      "Error of every method on cases it has not seen (NRMSE against the training cases' mean; 1 = no "
      "skill), with "
      "the measured coverage of 90 % intervals in brackets.");
  app.add_option("--store", options.store, "snapshot store")->required();
  app.add_option("--held-out", options.held_out, "names or patterns of the cases asked for")
      ->capture_default_str();
  app.add_option("--ignore", options.ignored, "cases that take no part")->capture_default_str();
  app.add_option("--methods", options.methods, "methods to compare")->delimiter(',')->capture_default_str();
  app.add_option("--fields", options.fields, "names or patterns of fields (all)")->delimiter(',');
  app.add_option("--sets", options.sets, "further trials, each holding back a share of the training cases")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "threads")->capture_default_str();
  app.add_option("--json", options.json, "write the tables as JSON");
  app.add_flag("--no-mirrors", options.no_mirrors, "do not use the furnace's symmetry");
  app.add_flag("--small", options.small, "two fields without \"auto\"; ends within a minute");
  CLI11_PARSE(app, argc, argv);
  if (options.small) {
    options.fields = {"pressure", "solid_velocity_z"};
    std::erase(options.methods, "auto");
  }
  return base::run_app("bench-accuracy", [&] { return run(options); });
}
