// bench-ablation: what each option of the networks buys and costs on real cases. Rows differ from the
// reference in one setting, or in those that they name; behind them networks on POD coefficients, the
// source's own method, and, to compare with, the kernel smoother and the best simple peer.
//
// Error: root mean square relative to that of the training mean (1 = no skill), mean of the fields. "cross"
// is over load-grouped folds of the training cases, by networks that did not see their fold, and is what
// decides whether an option is on by default; "held out" is beside it to be read, not to choose by. Bands and
// hyperparameters of the source's method come from all training cases. Seconds are those of the model that
// answers for the held-out cases.

#include <fmt/format.h>

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/methods/networks_method.hpp"
#include "elrom/methods/peers.hpp"
#include "elrom/methods/pod_mlp.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/study.hpp"
#include "elrom/torch/trainer.hpp"
#include "support/benchmark.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::ordered_json;
using Rows = std::vector<std::size_t>;
using Model = std::shared_ptr<const model::FieldModel>;

constexpr std::size_t n_folds = 3;

struct Options : benchmark::Arguments {
  std::vector<std::string> fields, variants;
  int source_trials = 10;
};

/// One row of the table: a way to read an answer out of a variant's trained models.
struct Reading {
  std::string name, what;
  std::function<Model(const Model&, const field::FieldData&)> read = [](const Model& model, const auto&) {
    return model;
  };
};

/// Models that are trained once and read in one or several ways.
struct Variant {
  std::vector<Reading> readings;
  std::function<std::unique_ptr<methods::Method>(const std::string& field)> make;
  std::string only = "";  ///< the one field it changes anything for
};

struct Outcome {
  double cross = 0, held_out = 0, seconds = 0;
};

Model average_of(const Model& model, const field::FieldData& data) {
  const auto& set = *data.cases;
  return std::make_shared<model::MirrorModel>(
      model, field::symmetry_group(set.mirrors, set.schema.size(), set.mesh.n_cells()), data.info.parity,
      set.mesh.n_planes);
}

Model best_build_of(const Model& model, const field::FieldData&) {
  auto parts = dynamic_cast<const model::BandedNetworks&>(*model).parts();
  parts.combination = model::Combination::best;
  return std::make_shared<model::BandedNetworks>(std::move(parts));
}

class Workbench {
 public:
  explicit Workbench(const Options& options)
      : options_(options),
        trainer_(elrom::torch::make_torch_trainer()),
        store_(field::SnapshotStore::open(options.store)) {
    const auto used = settings({});
    const auto held = study::hold_out(store_, study::held_out_patterns(store_, used, silent_log()));
    // Repeated runs judge noise, not skill: held out, but not judged.
    Rows rows = held.building;
    for (const std::size_t row : held.held_out)
      if (!store_.furnace() || !store_.furnace()->is_repeat(store_.cases()[row].inputs.name))
        rows.push_back(row);
    cases_ = study::study_cases(store_, used, rows, silent_log());
    rows_ = rows;
    for (std::size_t i = 0; i < rows.size(); ++i)
      (i < held.building.size() ? building_ : judged_).push_back(i);
    for (const auto& info : store_.fields())
      if (wanted(info.name)) fields_.push_back(info);
    columns_.resize(cases_.mesh.n_columns);
    std::iota(columns_.begin(), columns_.end(), 0);
  }

  void run() {
    fmt::print("{:<16} {:>8} {:>9} {:>9}  {}\n", "option", "cross", "held out", "seconds", "what");
    Json table = Json::array();
    for (const auto& variant : variants()) {
      const bool asked =
          options_.variants.empty() || std::ranges::any_of(variant.readings, [&](const auto& reading) {
            return std::ranges::count(options_.variants, reading.name) > 0;
          });
      if (!asked) continue;
      for (auto& row : measure(variant)) table.push_back(std::move(row));
    }
    if (!options_.json.empty())
      base::write_text(options_.json, Json{{"program", program_version()},
                                           {"small", options_.small},
                                           {"training_cases", building_.size()},
                                           {"held_out_cases", judged_.size()},
                                           {"folds", n_folds},
                                           {"source_trials", options_.source_trials},
                                           {"options", table}}
                                              .dump(1) +
                                          "\n");
  }

 private:
  [[nodiscard]] bool wanted(const std::string& field) const {
    if (!options_.fields.empty()) return std::ranges::count(options_.fields, field) > 0;
    return !options_.small || field == "pressure" || field == "solid_volume_fraction";
  }

  [[nodiscard]] study::Settings settings(const std::vector<std::string>& changes) const {
    const int epochs = options_.small ? 8 : 60;
    std::vector<std::string> all{
        "networks.plane_encoding=\"fourier\"",
        "networks.transform={}",
        "networks.targets=\"column\"",
        "networks.schedule=\"constant\"",
        "networks.mirrors=false",
        "networks.average=false",
        "networks.relevance=\"none\"",
        "fit.combine=\"mean\"",
        fmt::format("fit.max_epochs={}", epochs),
        fmt::format("fit.builds={}", options_.small ? 2 : 5),
        "fit.patience=8",
        fmt::format("search.max_epochs={}", std::max(9, epochs / 2)),
        fmt::format("search.trials={}", options_.small ? 2 : options_.source_trials)};
    all.insert(all.end(), changes.begin(), changes.end());
    return study::read_settings({}, all);
  }

  /// Networks of fixed hyperparameters, those that searches end near, on all columns together: nothing but
  /// the setting differs between rows.
  [[nodiscard]] auto networks(std::vector<std::string> changes,
                              std::function<void(networks::Hyperparameters&)> tune = {}) const {
    return [this, changes, tune](const std::string& field) -> std::unique_ptr<methods::Method> {
      auto method = std::make_unique<methods::NetworksMethod>(settings(changes), trainer_);
      methods::NetworkPlan plan;
      const auto n_columns = static_cast<std::ptrdiff_t>(columns_.size() / method->columns_each(data_));
      plan.bands = {{.name = "all", .columns = {columns_.begin(), columns_.begin() + n_columns}, .mask = {}}};
      networks::Hyperparameters h{.learning_rate = 2.5e-3, .n_layers = 2, .n_units = 64, .batch_size = 64};
      if (tune) tune(h);
      plan.hyperparameters = {{h}};
      method->keep_plan(field, plan);
      return method;
    };
  }

  [[nodiscard]] auto pod(const std::function<void(methods::PodMlpOptions&)>& change = {}) const {
    return [this, change](const std::string&) {
      methods::PodMlpOptions options;
      for (auto& recipe : options.recipes)
        if (options_.small) recipe.budget.max_epochs = 60;
      if (change) change(options);
      return methods::make_pod_mlp(trainer_, options);
    };
  }

  /// Screened by a network a column, banded, searched, bare plane index, no mirror images.
  [[nodiscard]] auto source() const {
    return [this](const std::string& field) -> std::unique_ptr<methods::Method> {
      auto method = std::make_unique<methods::NetworksMethod>(
          settings({"networks.plane_encoding=\"index\"", "fit.combine=\"best\"",
                    fmt::format("screen.max_epochs={}", options_.small ? 6 : 60)}),
          trainer_);
      method->keep_plan(field, method->plan(data_, building_, context()));
      return method;
    };
  }

  [[nodiscard]] std::vector<Variant> variants() const {
    using H = networks::Hyperparameters;
    const auto decay = [](H& h) { h.weight_decay = 0.1; };
    const auto log = networks({"networks.transform={solid_volume_fraction=\"log\"}"});
    const auto asinh = networks({"networks.transform={solid_volume_fraction=\"asinh\"}"});
    const std::string fraction = "solid_volume_fraction";
    const std::string cosine = "networks.schedule=\"cosine\"";
    const std::vector<std::string> both{"networks.mirrors=true", "networks.relevance=\"gp\""},
        defaults{both[0], both[1], cosine};
    return {
        {{{"reference", "2 x 64, Fourier planes, mean of the builds"},
          {"best", "best build instead of the mean", best_build_of},
          {"average", "averaged over mirror images at prediction", average_of}},
         networks({})},
        {{{"index", "bare plane index"}}, networks({"networks.plane_encoding=\"index\""})},
        {{{"one_hot", "one input a plane"}}, networks({"networks.plane_encoding=\"one_hot\""})},
        {{{"log", "log transform of the volume fraction"}}, log, fraction},
        {{{"asinh", "asinh transform of the volume fraction"}}, asinh, fraction},
        {{{"cell", "targets standardised cell by cell"}}, networks({"networks.targets=\"cell\""})},
        {{{"relevance", "inputs scaled by a ridge fit"}}, networks({"networks.relevance=\"linear\""})},
        {{{"relevance_gp", "inputs scaled by a process's length scales"}},
         networks({"networks.relevance=\"gp\""})},
        {{{"cosine", "a learning rate that falls by half a cosine"}}, networks({cosine})},
        {{{"decay", "weight decay 0.1"}}, networks({}, decay)},
        {{{"dropout", "dropout 0.1"}}, networks({}, [](H& h) { h.dropout = 0.1; })},
        {{{"mirrors", "the symmetric part over its scale, the kernel's asymmetry"}},
         networks({"networks.mirrors=true"})},
        {{{"mirrors_gp", "the same and length scales"}}, networks(both)},
        {{{"defaults", "the same, length scales, a learning rate that falls"}}, networks(defaults)},
        {{{"all", "the symmetric part, length scales, weight decay, dropout"}},
         networks(both,
                  [](H& h) {
                    h.weight_decay = 0.1;
                    h.dropout = 0.1;
                  })},
        {{{"pod_mlp", "networks on 15 POD coefficients, mean of five"}}, pod()},
        {{{"pod_mlp_unit", "the same, coefficients of unit variance"}}, pod([](auto& o) { o.equalise = 1; })},
        {{{"pod_mlp_plain", "the same, coefficients of one scale"}}, pod([](auto& o) { o.equalise = 0; })},
        {{{"pod_mlp_mirrors", "trained on mirror images too"},
          {"pod_mlp_average", "and averaged over them at prediction", average_of}},
         pod([](auto& o) { o.mirrors = true; })},
        {{{"source", fmt::format("screened, banded and searched as the source does, {} trials a submodel",
                                 options_.source_trials)}},
         source()},
        {{{"kernel", "kernel smoother"}}, [](const std::string&) { return methods::make_kernel_method(); }},
        {{{"pod_rbf", "POD + RBF"}}, [](const std::string&) { return methods::make_peer("pod_rbf"); }},
    };
  }

  std::vector<Json> measure(const Variant& variant) {
    std::vector<std::map<std::string, Outcome>> outcomes(variant.readings.size());
    for (const auto& info : fields_) {
      if (!variant.only.empty() && variant.only != info.name) continue;
      data_ = {&cases_, info, store_.read(info.name, rows_)};
      const auto of_field = measure_field(variant);
      for (std::size_t r = 0; r < of_field.size(); ++r) outcomes[r][info.name] = of_field[r];
    }
    std::vector<Json> rows;
    for (std::size_t r = 0; r < outcomes.size(); ++r)
      rows.push_back(report(variant.readings[r], outcomes[r]));
    return rows;
  }

  [[nodiscard]] std::vector<Outcome> measure_field(const Variant& variant) const {
    std::vector<Outcome> outcomes(variant.readings.size());
    std::vector<double> squares(variant.readings.size(), 0.0);
    const benchmark::Stopwatch watch;
    const auto method = variant.make(data_.info.name);
    const Model whole = method->fit(data_, building_, context());
    for (auto& outcome : outcomes) outcome.seconds = watch.seconds();
    for (std::size_t r = 0; r < outcomes.size(); ++r)
      outcomes[r].held_out =
          math::nrmse(squared_error(*variant.readings[r].read(whole, data_), judged_), departure(judged_));
    const auto folds = methods::load_grouped_folds(cases_.loads, building_, n_folds);
    for (std::size_t k = 0; k < folds.size(); ++k) {
      const Model model = method->fit(data_, methods::rows_without(folds, k), context());
      for (std::size_t r = 0; r < squares.size(); ++r)
        squares[r] += squared_error(*variant.readings[r].read(model, data_), folds[k]);
    }
    for (std::size_t r = 0; r < squares.size(); ++r)
      outcomes[r].cross = math::nrmse(squares[r], departure(building_));
    return outcomes;
  }

  /// Fields that the option leaves as they are count as in the reference.
  Json report(const Reading& reading, std::map<std::string, Outcome> outcomes) {
    if (reading.name == "reference") reference_ = outcomes;
    outcomes.insert(reference_.begin(), reference_.end());
    Outcome mean;
    Json fields = Json::object();
    for (const auto& [name, outcome] : outcomes) {
      const auto n = static_cast<double>(outcomes.size());
      mean.cross += outcome.cross / n;
      mean.held_out += outcome.held_out / n;
      mean.seconds += outcome.seconds;
      fields[name] = {{"cross", outcome.cross}, {"held_out", outcome.held_out}};
    }
    fmt::print("{:<16} {:>8.4f} {:>9.4f} {:>9.1f}  {}\n", reading.name, mean.cross, mean.held_out,
               mean.seconds, reading.what);
    std::fflush(stdout);
    return {{"name", reading.name},      {"what", reading.what},          {"cross", mean.cross},
            {"held_out", mean.held_out}, {"train_seconds", mean.seconds}, {"fields", fields}};
  }

  [[nodiscard]] methods::FitContext context() const {
    return {.seed = base::Seed(1), .n_threads = options_.threads, .stop = base::interrupt_token()};
  }

  /// Sum over cases and cells of the squares.
  [[nodiscard]] double squared_error(const model::FieldModel& model, const Rows& rows) const {
    std::vector<double> squares(rows.size());
    base::parallel_for(rows.size(), options_.threads, [&](std::size_t i, int) {
      const auto row = static_cast<Eigen::Index>(rows[i]);
      Eigen::RowVectorXf values(data_.values.cols());
      model::Workspace workspace;
      methods::predict_case(model, {cases_.inputs.row(row).data(), cases_.schema.size()},
                            cases_.mesh.n_planes, {values.data(), static_cast<std::size_t>(values.size())},
                            workspace);
      squares[i] = (data_.values.row(row) - values).cast<double>().squaredNorm();
    });
    return std::accumulate(squares.begin(), squares.end(), 0.0);
  }
  [[nodiscard]] double departure(const Rows& rows) const {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(data_.values.cols());
    for (const auto row : building_) mean += data_.values.row(static_cast<Eigen::Index>(row)).cast<double>();
    mean /= static_cast<double>(building_.size());
    double sum = 0;
    for (const auto row : rows)
      sum += (data_.values.row(static_cast<Eigen::Index>(row)).cast<double>() - mean).squaredNorm();
    return sum;
  }

  const Options& options_;
  std::shared_ptr<const networks::Trainer> trainer_;
  field::SnapshotStore store_;
  field::CaseSet cases_;    // training cases, then the held-out ones
  Rows rows_;               // of the store, in the order of cases_
  Rows building_, judged_;  // of cases_
  std::vector<field::FieldInfo> fields_;
  std::vector<std::int32_t> columns_;
  field::FieldData data_;  // the field at work
  std::map<std::string, Outcome> reference_;
};

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-ablation", [&] {
    base::keep_freed_memory();  // as elrom-train does
    Options options;
    benchmark::CommandLine line(
        "Error and training time of the networks' options on real cases, one switched at a time");
    options.add_to(line, "snapshot store", benchmark::CommandLine::Need::required);
    line.add_list("--fields", options.fields, "fields, separated by commas [default: all]");
    line.add_list("--options", options.variants, "rows of the table, separated by commas [default: all]");
    line.add("--source-trials", options.source_trials, "of the search in the source's method (it has 50)");
    if (const auto status = line.parse(argc, argv)) return *status;
    Workbench(options).run();
    return 0;
  });
}
