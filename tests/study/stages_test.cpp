// A stage is made anew when, and only when, something that it reads has changed: tried with every setting.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/text.hpp"
#include "elrom/study/study.hpp"
#include "study_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::study {
namespace {

// Every training ends alike, so the first trial of a search wins and only its range decides what is built.
class IndifferentTrainer final : public networks::Trainer {
 public:
  [[nodiscard]] std::string name() const override { return "indifferent"; }
  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters&,
                                               const networks::TrainingBudget&, base::Seed,
                                               networks::TrainingMonitor*, const std::stop_token&,
                                               const std::filesystem::path&) const override {
    const auto n_in = problem.train_inputs.cols(), n_out = problem.train_targets.cols();
    const std::vector<float> bias(static_cast<std::size_t>(n_out), 0.1F);
    networks::TrainingResult result;
    result.network = model::Network({{io::Tensor::copy(MatrixF(MatrixF::Zero(n_out, n_in))),
                                      io::Tensor::copy(std::span(bias), {bias.size()})}},
                                    model::Activation::relu);
    result.validation_mse = 0.5;
    result.epochs = 1;
    return result;
  }
};

using Names = std::set<std::string>;

class Stages : public ::testing::Test {
 protected:
  Stages() {
    write_small_store(folder.path() / "snapshots.h5", 20);
    std::filesystem::copy_file(folder.path() / "snapshots.h5", folder.path() / "copy.h5");
    write_mirror("across", 'y');
    run({});
  }
  void write_mirror(const std::string& name, char axis) const {
    base::write_text(folder.path() / "study.toml",
                     "[[symmetry.mirror]]\nname = \"" + name + "\"\naxis = \"" + axis + "\"\n");
  }
  void run(const std::vector<std::string>& changes) const {
    std::vector<std::string> overrides{"method=auto",
                                       "fields.names=[\"pressure\"]",
                                       "split.held_out=[\"load_*\"]",
                                       "screen.builds=1",
                                       "screen.n_units=2",
                                       "screen.max_epochs=1",
                                       "screen.patience=1",
                                       "bands.edges=[1e-9]",
                                       "search.trials=2",
                                       "search.confirm=2",
                                       "search.confirm_seeds=1",
                                       "search.max_epochs=1",
                                       "search.patience=1",
                                       "fit.builds=2",
                                       "fit.max_epochs=1",
                                       "fit.patience=1",
                                       "threads=2",
                                       "peers.methods=[\"linear\"]",
                                       "peers.folds=2"};
    overrides.insert(overrides.end(), changes.begin(), changes.end());
    Study(folder.path(), read_settings(folder.path() / "study.toml", overrides),
          {.trainer = std::make_shared<IndifferentTrainer>()}, silent_log(), {})
        .run();
  }
  /// "build-pressure_from_1e_09_0-0123abcd.elrom"
  [[nodiscard]] Names files() const {
    Names names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "stages"))
      names.insert(entry.path().filename().string());
    return names;
  }
  /// Stages made by a run with this change, models with their method: "screen", "model auto".
  [[nodiscard]] Names made_anew(const std::vector<std::string>& changes) const {
    const auto before = files();
    run(changes);
    Names stages;
    for (const auto& file : files()) {
      if (before.contains(file)) continue;
      const auto parts = base::split(file, '-');
      stages.insert(parts[0] == "model" ? "model " + base::split(parts[1], '_')[0] : parts[0]);
      std::filesystem::remove(folder.path() / "stages" / file);
    }
    return stages;
  }

  test::TemporaryFolder folder;
};

Names operator+(Names a, const Names& b) {
  a.insert(b.begin(), b.end());
  return a;
}

struct Effect {
  std::string value;
  Names stages;  ///< made anew for it
};

std::map<std::string, Effect> effects() {
  const Names none, screen{"screen"}, search{"search"}, build{"build"},
      networks{"model auto", "model networks"}, from_search = search + build + networks,
                                                from_records = screen + from_search,
                                                all = from_records + Names{"model linear"};
  return {{"effort", {"thorough", none}},  // what it sets is set by itself here
          {"method", {"linear", {"model linear"}}},
          {"store", {"copy.h5", none}},
          {"seed", {"2", all}},
          {"threads", {"1", none}},
          {"device", {"cuda", none}},  // reaches stages by the trainer's name
          {"date", {"\"2026-11-24\"", none}},
          {"train.exclude", {"[\"train_0\"]", all}},
          {"gate.tolerance", {"0.02", none}},
          {"gate.deviations", {"2", none}},
          {"fields.names", {"[\"gas_velocity_z\"]", all}},
          {"split.held_out", {"[\"load_*\", \"train_0\"]", all}},
          {"split.by", {"record", from_records}},
          {"split.fractions", {"[0.6, 0.3, 0.1]", from_records}},
          {"symmetry.enabled", {"false", from_records}},
          {"symmetry.mirror", {"[{ axis = \"x\" }]", from_records}},
          {"screen.method", {"fast", screen + networks}},
          {"screen.builds", {"2", screen + networks}},
          {"screen.n_units", {"3", screen + networks}},
          {"screen.batch_size", {"8", screen + networks}},
          {"screen.epoch_records", {"20", screen + networks}},
          {"screen.learning_rate", {"0.01", screen + networks}},
          {"screen.max_epochs", {"2", screen + networks}},
          {"screen.patience", {"2", screen + networks}},
          {"screen.features", {"100", none}},  // the closed-form screen's
          {"bands.scope", {"plane", from_search}},
          {"bands.edges", {"[1e-8]", from_search}},
          {"search.algorithm", {"random", from_search}},
          {"search.trials", {"3", search + networks}},
          {"search.prune", {"false", search + networks}},
          {"search.confirm", {"3", search + networks}},
          {"search.confirm_seeds", {"2", search + networks}},
          {"search.max_epochs", {"2", search + networks}},
          {"search.patience", {"2", search + networks}},
          {"search.learning_rate", {"[1e-3, 1e-3]", from_search}},
          {"search.n_layers", {"[1, 1]", from_search}},
          {"search.n_units", {"[16, 16]", from_search}},
          {"search.batch_size", {"[32, 32]", from_search}},
          {"search.weight_decay", {"[1e-5, 1e-2]", none}},  // searched with search.regularise only
          {"search.dropout", {"[0.1, 0.2]", none}},
          {"search.regularise", {"true", from_search}},
          {"fit.builds", {"3", build + networks}},
          {"fit.combine", {"best", build + networks}},
          {"fit.max_epochs", {"2", build + networks}},
          {"fit.patience", {"2", build + networks}},
          {"networks.plane_encoding", {"index", from_search}},
          {"networks.activation", {"tanh", from_search}},
          {"networks.targets", {"cell", from_records}},
          {"networks.epoch_records", {"20", from_search}},
          {"networks.schedule", {"constant", from_search}},
          {"networks.mirrors", {"false", from_records}},
          {"networks.average", {"true", none}},  // read with networks.mirrors=false only
          {"networks.relevance", {"none", from_search}},
          {"networks.transform", {"{ pressure = \"asinh\" }", from_records}},
          {"peers.methods", {"[\"linear\", \"nearest\"]", {"model auto", "model nearest"}}},
          {"peers.networks", {"false", {"model auto"}}},
          {"peers.folds", {"3", {"build", "model auto"}}}};
}

TEST_F(Stages, EverySettingMakesThoseAnewThatReadIt) {
  EXPECT_EQ(made_anew({}), Names()) << "the same settings";
  auto table = effects();
  for (const auto& setting : settings_help()) {
    const auto row = table.extract(setting.key);
    if (row.empty()) {
      ADD_FAILURE() << setting.key << ": say in effects() which stages read it";
      continue;
    }
    EXPECT_EQ(made_anew({setting.key + "=" + row.mapped().value}), row.mapped().stages) << setting.key;
  }
  EXPECT_TRUE(table.empty()) << table.begin()->first << " is no setting";
}

TEST_F(Stages, AnotherMirrorMakesAllAnewThatLearnTheSymmetricPart) {
  write_mirror("along", 'x');
  EXPECT_EQ(made_anew({}), (Names{"screen", "search", "build", "model auto", "model networks"}));
}

TEST_F(Stages, AnotherFieldsTransformLeavesThisOneAlone) {
  EXPECT_EQ(made_anew({"networks.transform={ gas_velocity_z = \"log\" }"}), Names());
}

}  // namespace
}  // namespace elrom::study
