// bench-ablation: what each option of the networks buys and costs on real cases. Every variant differs from
// the reference in one setting; the last rows are the networks on POD coefficients and the source's own
// method as written.
//
// Error: root mean square over the judged cases, relative to that of the training mean (1 = no skill), mean
// of the fields. Judged are the held-out cases, or (--cross) the cases of load-grouped folds of the training
// cases, which is what settings are tuned with.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/study/cross_validation.hpp"
#include "elrom/study/networks_method.hpp"
#include "elrom/study/pod_mlp.hpp"
#include "elrom/study/study.hpp"
#include "elrom/torch/trainer.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::json;

struct Options {
  std::string store = "snapshots.h5", json;
  std::vector<std::string> fields, variants;
  bool small = false, cross = false;
  int threads = base::available_threads();
};

/// A method with its symmetric average at prediction.
class MirrorAveraged final : public study::Method {
 public:
  explicit MirrorAveraged(std::unique_ptr<study::Method> method) : method_(std::move(method)) {}
  [[nodiscard]] std::string name() const override { return method_->name(); }
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const study::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const study::FitContext& context) const override {
    const auto& set = *data.cases;
    return std::make_unique<model::MirrorModel>(
        method_->fit(data, cases, context),
        field::symmetry_group(set.mirrors, set.schema.size(), set.mesh.n_cells()), data.info.parity,
        set.mesh.n_planes);
  }
  [[nodiscard]] MatrixF cross_predict(const study::FieldData& data, const study::Folds& folds,
                                      const study::FitContext& context) const override {
    return study::cross_predict_by_fitting(*this, data, folds, context, false);
  }

 private:
  std::unique_ptr<study::Method> method_;
};

/// One row of the table: how to make its method for a field.
struct Variant {
  std::string name, what;
  std::function<std::unique_ptr<study::Method>()> make;
};

class Workbench {
 public:
  explicit Workbench(const Options& options)
      : options_(options), trainer_(elrom::torch::make_torch_trainer()) {}

  [[nodiscard]] study::Settings settings(const std::vector<std::string>& changes) const {
    const int epochs = options_.small ? 8 : 60, trials = options_.small ? 2 : 10;
    std::vector<std::string> all{"screen.method=\"fast\"",
                                 "networks.plane_encoding=\"fourier\"",
                                 "networks.transform={}",
                                 "networks.targets=\"column\"",
                                 "networks.mirrors=false",
                                 "networks.relevance=\"none\"",
                                 "fit.combine=\"mean\"",
                                 fmt::format("fit.max_epochs={}", epochs),
                                 fmt::format("fit.builds={}", options_.small ? 2 : 5),
                                 "fit.patience=12",
                                 fmt::format("search.max_epochs={}", std::max(9, epochs / 2)),
                                 fmt::format("search.trials={}", trials),
                                 "search.confirm=2",
                                 "search.confirm_seeds=2"};
    all.insert(all.end(), changes.begin(), changes.end());
    return study::read_settings({}, all);
  }

  /// Networks of fixed hyperparameters on all columns together: nothing but the setting differs between
  /// variants.
  [[nodiscard]] std::function<std::unique_ptr<study::Method>()> networks(
      std::vector<std::string> changes, std::function<void(study::Hyperparameters&)> tune = {},
      bool average = false) const {
    return [this, changes, tune, average]() -> std::unique_ptr<study::Method> {
      auto method = std::make_unique<study::NetworksMethod>(settings(changes), trainer_);
      study::NetworkPlan plan;
      plan.bands = {{.name = "all", .columns = columns_, .mask = {}}};
      study::Hyperparameters h{.learning_rate = 1e-3, .n_layers = 2, .n_units = 64, .batch_size = 64};
      if (tune) tune(h);
      plan.hyperparameters = {h};
      for (const auto& field : fields_) method->keep_plan(field, plan);
      if (average) return std::make_unique<MirrorAveraged>(std::move(method));
      return method;
    };
  }

  [[nodiscard]] std::function<std::unique_ptr<study::Method>()> pod(
      const std::function<void(study::PodMlpOptions&)>& change = {}, bool average = false) const {
    return [this, change, average]() -> std::unique_ptr<study::Method> {
      study::PodMlpOptions options;
      if (options_.small) options.budget.max_epochs = 60;
      if (change) change(options);
      auto method = study::make_pod_mlp(trainer_, options);
      if (average) return std::make_unique<MirrorAveraged>(std::move(method));
      return method;
    };
  }

  [[nodiscard]] std::vector<Variant> variants() const {
    const std::vector<std::string> mirrors{"networks.mirrors=true"};
    return {
        {"reference", "2 x 64, Fourier planes, mean of the builds", networks({})},
        {"index", "bare plane index", networks({"networks.plane_encoding=\"index\""})},
        {"one_hot", "one input a plane", networks({"networks.plane_encoding=\"one_hot\""})},
        {"best", "best build instead of the mean", networks({"fit.combine=\"best\""})},
        {"log", "log transform of the volume fraction",
         networks({"networks.transform={solid_volume_fraction=\"log\"}"})},
        {"asinh", "asinh transform of the volume fraction",
         networks({"networks.transform={solid_volume_fraction=\"asinh\"}"})},
        {"cell", "targets standardised cell by cell", networks({"networks.targets=\"cell\""})},
        {"relevance", "inputs scaled by a ridge fit", networks({"networks.relevance=\"linear\""})},
        {"decay", "weight decay 0.1", networks({}, [](auto& h) { h.weight_decay = 0.1; })},
        {"dropout", "dropout 0.1", networks({}, [](auto& h) { h.dropout = 0.1; })},
        {"mirrors", "trained on mirror images too", networks(mirrors)},
        {"mirrors_average", "and averaged over them at prediction", networks(mirrors, {}, true)},
        {"average", "averaged over mirror images at prediction only", networks({}, {}, true)},
        {"all_on", "mirrors, average, cell targets, relevance, decay",
         networks(
             {"networks.mirrors=true", "networks.targets=\"cell\"", "networks.relevance=\"linear\""},
             [](auto& h) { h.weight_decay = 0.1; }, true)},
        {"pod_mlp", "networks on 15 POD coefficients, mean of five", pod()},
        {"pod_mlp_unit", "the same, coefficients of unit variance", pod([](auto& o) { o.equalise = 1; })},
        {"pod_mlp_plain", "the same, coefficients of one scale", pod([](auto& o) { o.equalise = 0; })},
        {"pod_mlp_mirrors", "the same, with mirror images and their average",
         pod([](auto& o) { o.mirrors = true; }, true)},
        {"source", "the source's method as written: screened, banded, searched, bare index, best build",
         [this] {
           return std::make_unique<study::NetworksMethod>(
               settings({"networks.plane_encoding=\"index\"", "fit.combine=\"best\"",
                         "screen.method=\"networks\"",
                         fmt::format("screen.max_epochs={}", options_.small ? 6 : 40)}),
               trainer_);
         }},
    };
  }

  void run() {
    const auto store = field::SnapshotStore::open(options_.store);
    const auto settings_used = settings({});
    std::vector<std::string> names;
    for (const auto& record : store.cases()) names.push_back(record.inputs.name);
    const auto held = study::hold_out(names, settings_used.split.held_out);
    // Repeated runs judge noise, not skill: held out, but not judged.
    std::vector<std::size_t> judged;
    for (const std::size_t row : held.held_out)
      if (!base::matches(names[row], "rep*")) judged.push_back(row);
    building_ = study::study_cases(store, settings_used, held.building, silent_log());
    judged_ = study::study_cases(store, settings_used, judged, silent_log());
    for (const auto& info : store.fields()) fields_.push_back(info.name);
    if (!options_.fields.empty()) fields_ = options_.fields;
    if (options_.small && options_.fields.empty()) fields_ = {"pressure", "solid_volume_fraction"};
    columns_.resize(store.mesh().n_columns);
    std::iota(columns_.begin(), columns_.end(), 0);
    print_header();
    Json rows = Json::array();
    for (const auto& variant : variants())
      if (options_.variants.empty() || std::ranges::count(options_.variants, variant.name) > 0)
        rows.push_back(measure(variant, store, held.building, judged));
    if (!options_.json.empty())
      base::write_text(
          options_.json,
          Json{{"judged", options_.cross ? "cross-validation" : "held-out"}, {"variants", rows}}.dump(2) +
              "\n");
  }

 private:
  void print_header() const {
    fmt::print("{:<16} {:>8} {:>9}  {}\n", "variant", "NRMSE", "seconds", base::join(fields_, " "));
  }

  Json measure(const Variant& variant, const field::SnapshotStore& store,
               const std::vector<std::size_t>& building, const std::vector<std::size_t>& judged) const {
    Json row{{"name", variant.name}, {"what", variant.what}, {"fields", Json::object()}};
    double sum = 0, seconds = 0;
    std::string details;
    for (const auto& name : fields_) {
      const study::FieldData data{&building_, info_of(store, name), store.read(name, building)};
      const auto begin = std::chrono::steady_clock::now();
      const auto method = variant.make();
      const double error = options_.cross ? cross_error(*method, data)
                                          : held_out_error(*method, data, store.read(name, judged));
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      row["fields"][name] = error;
      sum += error;
      details += fmt::format(" {:.3f}", error);
    }
    row["error"] = sum / static_cast<double>(fields_.size());
    row["train_seconds"] = seconds;
    fmt::print("{:<16} {:>8.4f} {:>9.1f} {}\n", variant.name, row["error"].get<double>(), seconds, details);
    std::fflush(stdout);
    return row;
  }

  [[nodiscard]] static field::FieldInfo info_of(const field::SnapshotStore& store, const std::string& name) {
    for (const auto& info : store.fields())
      if (info.name == name) return info;
    throw UsageError({.what = "unknown field", .found = name});
  }

  [[nodiscard]] study::FitContext context() const {
    return {.seed = base::Seed(1), .n_threads = options_.threads, .stop = base::interrupt_token()};
  }

  [[nodiscard]] static double relative_error(const MatrixF& truth, const MatrixF& predicted,
                                             const Eigen::RowVectorXf& mean) {
    return std::sqrt((truth - predicted).cast<double>().squaredNorm() /
                     (truth.rowwise() - mean).cast<double>().squaredNorm());
  }

  [[nodiscard]] double held_out_error(const study::Method& method, const study::FieldData& data,
                                      const MatrixF& truth) const {
    std::vector<std::size_t> all(data.cases->n_cases());
    std::iota(all.begin(), all.end(), 0);
    const auto model = method.fit(data, all, context());
    MatrixF predicted(truth.rows(), truth.cols());
    model::Workspace workspace;
    for (Eigen::Index i = 0; i < truth.rows(); ++i)
      study::predict_case(*model, {judged_.inputs.row(i).data(), judged_.schema.size()},
                          judged_.mesh.n_planes,
                          {predicted.row(i).data(), static_cast<std::size_t>(predicted.cols())}, workspace);
    return relative_error(truth, predicted, data.values.colwise().mean());
  }

  [[nodiscard]] double cross_error(const study::Method& method, const study::FieldData& data) const {
    std::vector<std::size_t> all(data.cases->n_cases());
    std::iota(all.begin(), all.end(), 0);
    const auto folds = study::load_grouped_folds(data.cases->loads, all, 5);
    return relative_error(data.values, method.cross_predict(data, folds, context()),
                          data.values.colwise().mean());
  }

  const Options& options_;
  std::shared_ptr<const study::Trainer> trainer_;
  study::CaseSet building_, judged_;
  std::vector<std::string> fields_;
  std::vector<std::int32_t> columns_;
};

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-ablation", [&] {
    Options options;
    CLI::App app("Error and training time of the networks' options on real cases, one switched at a time");
    app.add_option("--store", options.store, "snapshot store")->capture_default_str();
    app.add_option("--fields", options.fields, "fields, separated by commas [default: all]")->delimiter(',');
    app.add_option("--variants", options.variants, "rows of the table, separated by commas [default: all]")
        ->delimiter(',');
    app.add_flag("--cross", options.cross, "judge by cross-validation on the training cases");
    app.add_flag("--small", options.small, "two fields and tiny budgets: ends within a minute");
    app.add_option("--threads", options.threads, "processor threads")->capture_default_str();
    app.add_option("--json", options.json, "write the figures to this file");
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : static_cast<int>(ExitStatus::usage);
    }
    Workbench(options).run();
    return 0;
  });
}
