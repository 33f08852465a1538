#include "elrom/study/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/versions.hpp"
#include "study_fixture.hpp"
#include "support/recording_log.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::study {
namespace {

using ::testing::HasSubstr;

// "Trains" a network without hidden layers: the targets' mean as bias, and weights that follow rate and seed.
// Counts its calls; can be killed.
class MeanTrainer final : public networks::Trainer {
 public:
  [[nodiscard]] std::string name() const override { return "mean"; }
  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters& hyperparameters,
                                               const networks::TrainingBudget&, base::Seed seed,
                                               networks::TrainingMonitor*, const std::stop_token&,
                                               const std::filesystem::path&) const override {
    if (++calls == kill_at) throw Interrupted("killed");
    const auto n_in = problem.train_inputs.cols(), n_out = problem.train_targets.cols();
    const Eigen::RowVectorXf mean = problem.train_targets.colwise().mean();
    const auto slope = static_cast<float>(hyperparameters.learning_rate * (1 + base::Random(seed).uniform()));
    const std::vector<float> bias(mean.data(), mean.data() + n_out);
    networks::TrainingResult result;
    result.network = model::Network({{io::Tensor::copy(MatrixF(MatrixF::Constant(n_out, n_in, slope))),
                                      io::Tensor::copy(std::span(bias), {bias.size()})}},
                                    model::Activation::relu);
    result.validation_mse = (problem.validation_targets.rowwise() - mean).squaredNorm() /
                                static_cast<double>(problem.validation_targets.size()) +
                            slope;
    result.epochs = 1;
    return result;
  }
  mutable std::atomic<int> calls{0};
  int kill_at = -1;
};

class SmallStudy : public ::testing::Test {
 protected:
  SmallStudy() { write_small_store(folder.path() / "snapshots.h5", 20); }
  Settings settings(const std::string& method) const {
    return read_settings(folder.path() / "study.toml",
                         {"effort=quick", "method=" + method, "threads=2",
                          "peers.methods=[\"nearest\", \"linear\"]", "peers.folds=3"});
  }
  std::vector<FieldOutcome> run(const std::string& method) {
    return Study(folder.path(), settings(method), {.trainer = trainer}, silent_log(), {}).run();
  }
  /// All that a run could take up again.
  void forget() const {
    for (const auto* name : {"stages", "search.sqlite", "search.sqlite-wal", "search.sqlite-shm",
                             "model.elrom", "models", "peers"})
      std::filesystem::remove_all(folder.path() / name);
  }
  std::string bundle_digest() const { return base::sha256_file(folder.path() / "model.elrom"); }
  nlohmann::json timing() const {
    return nlohmann::json::parse(base::read_text(folder.path() / "timing.json"));
  }

  test::TemporaryFolder folder;
  std::shared_ptr<MeanTrainer> trainer = std::make_shared<MeanTrainer>();
};

TEST_F(SmallStudy, RunWritesModelPeersSplitAndSettings) {
  const auto outcomes = run("linear");

  EXPECT_THAT(outcomes, ::testing::SizeIs(2));
  for (const auto* file : {"model.elrom", "peers/nearest.elrom", "peers/networks.elrom", "resolved.toml",
                           "split.json", "timing.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder.path() / file)) << file;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "peers/linear.elrom"))
      << "the model itself is no peer";
  const auto split = read_split(folder.path() / "split.json");
  EXPECT_EQ(split.held_out.size(), 4u);
  EXPECT_EQ(split.train.size() + split.validation.size() + split.test.size(), 16u);
}

TEST_F(SmallStudy, HeldOutCasesAreTheSettingsOrElseTheFurnaces) {
  run("linear");
  EXPECT_EQ(read_split(folder.path() / "split.json").held_out.size(), 4u);
  EXPECT_THAT(base::read_text(folder.path() / "resolved.toml"), HasSubstr("held_out = [\"load_*\"]"));

  base::write_text(folder.path() / "study.toml", "[split]\nheld_out = [\"train_3\"]\n");
  run("linear");
  EXPECT_THAT(read_split(folder.path() / "split.json").held_out, ::testing::ElementsAre("train_3"));
}

TEST_F(SmallStudy, TheBundlesCarryTheStoresFurnace) {
  run("linear");

  for (const auto* file : {"model.elrom", "peers/nearest.elrom"}) {
    const auto furnace = model::BundleReader(folder.path() / file).furnace();
    ASSERT_TRUE(furnace.has_value()) << file;
    EXPECT_EQ(field::to_toml(*furnace), field::to_toml(small_furnace()));
  }
}

// Nothing is trained anew for it, but the bundle is another one.
TEST_F(SmallStudy, AnotherFurnaceOfTheStoreReachesTheBundle) {
  run("linear");
  auto other = small_furnace();
  other.openings[1].high_m = 3;
  write_small_store(folder.path() / "snapshots.h5", 0, 0, other);

  run("linear");

  EXPECT_EQ(model::BundleReader(folder.path() / "model.elrom").furnace()->openings[1].high_m, 3);
}

TEST_F(SmallStudy, WithoutAFurnaceWhatIsMissingIsTold) {
  std::filesystem::remove(folder.path() / "snapshots.h5");
  write_small_store(folder.path() / "snapshots.h5", 20, 0, std::nullopt);
  test::RecordingLog log;

  Study(folder.path(), settings("linear"), {.trainer = trainer}, log, {}).run();

  EXPECT_TRUE(read_split(folder.path() / "split.json").held_out.empty());
  EXPECT_THAT(log.text(), HasSubstr("no case is held out: the store has no furnace description"));
  EXPECT_THAT(log.text(), HasSubstr("no mirror images: the store has no furnace description"));
  EXPECT_FALSE(model::BundleReader(folder.path() / "model.elrom").furnace().has_value());
}

TEST_F(SmallStudy, AMirrorOfTheFurnaceThatDoesNotFitIsTold) {
  auto furnace = small_furnace();
  furnace.mirrors = {{.name = "across", .axis = 'y', .swap = {{"*_left", "*_right"}}}};
  write_small_store(folder.path() / "snapshots.h5", 0, 0, furnace);
  test::RecordingLog log;

  const Study study(folder.path(), settings("linear"), {.trainer = trainer}, log, {});

  EXPECT_TRUE(study.cases().mirrors.empty());
  EXPECT_THAT(log.text(), HasSubstr("mirror 'across' of the furnace not used"));
}

TEST_F(SmallStudy, MirrorsAreTheFurnacesUnlessTheSettingsDeclareSome) {
  auto furnace = small_furnace();
  furnace.mirrors = {{.name = "across", .axis = 'y', .swap = {}}};
  write_small_store(folder.path() / "snapshots.h5", 0, 0, furnace);
  const auto names = [&](const Settings& used) {
    const Study study(folder.path(), used, {.trainer = trainer}, silent_log(), {});
    std::vector<std::string> found;
    for (const auto& mirror : study.cases().mirrors) found.push_back(mirror.name);
    return found;
  };
  auto own = settings("linear");
  own.symmetry.mirrors = {{.name = "along", .axis = 'x', .swap = {}}};
  auto off = settings("linear");
  off.symmetry.enabled = false;

  EXPECT_THAT(names(settings("linear")), ::testing::ElementsAre("across"));
  EXPECT_THAT(names(own), ::testing::ElementsAre("along"));
  EXPECT_THAT(names(off), ::testing::IsEmpty());
}

TEST_F(SmallStudy, ModelPredictsHeldOutCasesBetterThanTheirMean) {
  const auto outcomes = run("linear");

  EXPECT_LT(outcomes[0].cross_validated_nrmse, 0.2);
  const model::Predictor predictor(folder.path() / "model.elrom", {.fields = {"pressure"}});
  const auto store = field::SnapshotStore::open(folder.path() / "snapshots.h5");
  const auto held_out = store.find("load_*");
  const auto truth = store.read("pressure", held_out);
  const auto inputs = store.inputs(held_out);
  std::vector<float> values(predictor.size());
  model::Predictor::Scratch scratch;
  predictor.predict({inputs.row(0).data(), 3}, values, {}, scratch);
  for (std::size_t c = 0; c < values.size(); ++c)
    EXPECT_NEAR(values[c], truth(0, static_cast<Eigen::Index>(c)), 60) << "values span 1000 Pa";
}

TEST_F(SmallStudy, BundleKnowsItsCasesAndCarriesIntervals) {
  run("linear");

  const model::BundleReader reader(folder.path() / "model.elrom");
  EXPECT_EQ(reader.info().cases.size(), 16u);
  EXPECT_EQ(reader.info().method, "linear");
  EXPECT_NE(reader.uncertainty("pressure"), nullptr);
  EXPECT_TRUE(nlohmann::json::parse(reader.info().accuracy_json)["pressure"]["nrmse"].is_number());
}

TEST_F(SmallStudy, SecondRunRedoesNothingAndWritesTheSameBytes) {
  run("networks");
  const auto first = bundle_digest();
  const int calls = trainer->calls;

  run("networks");

  EXPECT_EQ(trainer->calls, calls);
  EXPECT_EQ(bundle_digest(), first);
  for (const auto* stage : {"screen", "model"}) {
    if (timing()["stages"].contains(stage)) {
      EXPECT_EQ(timing()["stages"][stage]["computed"], 0) << stage;
    }
  }
}

TEST_F(SmallStudy, ASecondRunIsNoNewVersion) {
  run("linear");
  Study study(folder.path(), settings("linear"), {.trainer = trainer}, silent_log(), {});

  study.run();

  EXPECT_EQ(study.promotion().kind, Promotion::Kind::unchanged);
  EXPECT_EQ(study.promotion().number, 1);
  EXPECT_EQ(Versions(folder.path()).numbers().size(), 1u);
}

TEST_F(SmallStudy, ADateAloneIsNoNewVersion) {
  run("linear");
  auto dated = settings("linear");
  dated.date = "2026-11-24";
  Study study(folder.path(), dated, {.trainer = trainer}, silent_log(), {});

  study.run();

  EXPECT_EQ(study.promotion().kind, Promotion::Kind::unchanged);
}

TEST_F(SmallStudy, ARefusedModelLeavesThePeersAsTheyAre) {
  run("linear");
  const auto peer = folder.path() / "peers/nearest.elrom";
  const auto before = test::read_bytes(peer);
  write_small_store(folder.path() / "snapshots.h5", 5, 20);
  auto worse = settings("nearest");
  worse.peers.methods = {"linear"};
  Study study(folder.path(), worse, {.trainer = trainer}, silent_log(), {});

  study.run();

  EXPECT_EQ(study.promotion().kind, Promotion::Kind::refused);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "peers/linear.elrom"));
  EXPECT_EQ(test::read_bytes(peer), before);
}

TEST_F(SmallStudy, ADamagedModelIsReplacedWithoutBeingCompared) {
  run("linear");
  std::filesystem::resize_file(folder.path() / "models/1.elrom", 1000);
  test::RecordingLog log;
  Study study(folder.path(), settings("linear"), {.trainer = trainer}, log, {});

  study.run();

  EXPECT_EQ(study.promotion().number, 2);
  EXPECT_THAT(log.text(), HasSubstr("cannot be read"));
  EXPECT_EQ(model::BundleReader(folder.path() / "model.elrom").info().method, "linear");
}

TEST_F(SmallStudy, AnExcludedCaseIsNeitherTrainedOnNorHeldOut) {
  auto without = settings("linear");
  without.train.exclude = {"train_3", "load_4"};

  Study(folder.path(), without, {.trainer = trainer}, silent_log(), {}).run();

  const auto split = read_split(folder.path() / "split.json");
  EXPECT_THAT(split.excluded, ::testing::ElementsAre("train_3", "load_4"));
  EXPECT_EQ(split.held_out.size(), 3u);
  EXPECT_EQ(split.train.size() + split.validation.size() + split.test.size(), 15u);
  EXPECT_THAT(model::BundleReader(folder.path() / "model.elrom").info().cases,
              ::testing::Not(::testing::Contains("train_3")));
}

TEST_F(SmallStudy, APatternThatMatchesNoCaseIsRefusedWithTheNearest) {
  auto held_out = settings("linear"), excluded = settings("linear");
  held_out.split.held_out = {"lod_4"};
  excluded.train.exclude = {"trian_3"};
  const auto make = [&](const Settings& used) {
    return Study(folder.path(), used, {.trainer = trainer}, silent_log(), {}).held_out().size();
  };

  EXPECT_ERROR(UsageError, "did you mean 'load_4'", make(held_out));
  EXPECT_ERROR(UsageError, "train.exclude", make(excluded));
}

TEST_F(SmallStudy, AFurnacesPatternThatMatchesNoCaseIsTold) {
  auto furnace = small_furnace();
  furnace.held_out = {"load_*", "rep*"};
  write_small_store(folder.path() / "snapshots.h5", 0, 0, furnace);
  test::RecordingLog log;

  const Study study(folder.path(), settings("linear"), {.trainer = trainer}, log, {});

  EXPECT_THAT(log.text(), HasSubstr("no case matches 'rep*'"));
}

TEST_F(SmallStudy, AStoreThatIsGoneIsTold) {
  std::filesystem::remove(folder.path() / "snapshots.h5");

  EXPECT_ERROR(InputError, "--store",
               Study(folder.path(), settings("linear"), {}, silent_log(), {}).held_out().size());
}

TEST_F(SmallStudy, TheStoreOfTheLastRunIsRemembered) {
  const auto study = folder.path() / "study", store = folder.path() / "snapshots.h5";
  auto given = settings("linear");
  given.store = store.string();
  Study(study, given, {.trainer = trainer}, silent_log(), {}).fit();

  EXPECT_EQ(study_settings(study).store, "../snapshots.h5") << "moves with the study";
  EXPECT_EQ(study_settings(study, {"store=other.h5"}).store, "other.h5");
  base::write_text(study / "study.toml", "store = \"own.h5\"\n");
  EXPECT_EQ(study_settings(study).store, "own.h5");
  EXPECT_EQ(study_settings(folder.path() / "new").store, "snapshots.h5");
}

TEST_F(SmallStudy, RunKilledInTheMiddleEndsWithTheSameBundle) {
  run("networks");
  const auto expected = bundle_digest();
  for (const int kill_at : {1, 5, 12}) {
    forget();
    trainer->calls = 0;
    trainer->kill_at = kill_at;
    EXPECT_THROW(run("networks"), Interrupted);
    trainer->kill_at = -1;

    run("networks");

    EXPECT_EQ(bundle_digest(), expected) << "killed at call " << kill_at;
  }
}

TEST_F(SmallStudy, ThreadsDoNotChangeTheBundle) {
  run("networks");
  const auto two = bundle_digest();
  forget();
  auto one_thread = settings("networks");
  one_thread.threads = 1;

  Study(folder.path(), one_thread, {.trainer = trainer}, silent_log(), {}).run();

  EXPECT_EQ(bundle_digest(), two);
}

TEST_F(SmallStudy, DamagedStageIsComputedAgain) {
  run("linear");
  const auto expected = bundle_digest();
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "stages")) {
    std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) / 2);
  }
  std::filesystem::remove_all(folder.path() / "models");

  run("linear");

  EXPECT_EQ(bundle_digest(), expected);
}

TEST_F(SmallStudy, PlaneScopeAnswersForEveryCell) {
  auto by_plane = settings("networks");
  by_plane.bands.scope = "plane";

  Study(folder.path(), by_plane, {.trainer = trainer}, silent_log(), {}).fit();

  const model::Predictor predictor(folder.path() / "model.elrom");
  std::vector<float> values(predictor.size());
  model::Predictor::Scratch scratch;
  predictor.predict(std::vector<double>{70, 1.5, 3}, values, {}, scratch);
  for (const float value : values) EXPECT_TRUE(std::isfinite(value));
}

TEST_F(SmallStudy, AutoChoosesSomethingThatBeatsTheMean) {
  const auto outcomes = run("auto");

  for (const auto& outcome : outcomes)
    EXPECT_LT(outcome.cross_validated_nrmse, 0.7) << outcome.field << ": " << outcome.method;
}

TEST_F(SmallStudy, NetworksWithoutATrainerAreNotBuilt) {
  EXPECT_THROW(Study(folder.path(), settings("networks"), {}, silent_log(), {}), NotBuiltError);
  EXPECT_NO_THROW(Study(folder.path(), settings("linear"), {}, silent_log(), {}).screen())
      << "the screening is our own";
}

TEST_F(SmallStudy, UnknownFieldIsRefusedWithTheNearest) {
  auto wrong = settings("linear");
  wrong.fields = {"presure"};

  EXPECT_THROW(Study(folder.path(), wrong, {}, silent_log(), {}), UsageError);
}

TEST_F(SmallStudy, SecondProcessIsRefusedByTheLock) {
  const Study first(folder.path(), settings("linear"), {}, silent_log(), {});

  EXPECT_THROW(Study(folder.path(), settings("linear"), {}, silent_log(), {}), UsageError);
}

TEST_F(SmallStudy, RetrainingReusesTheEarlierPlan) {
  auto one_band = settings("networks");
  one_band.bands.edges = {1e-9};  // whatever the new cases show
  Study(folder.path(), one_band, {.trainer = trainer}, silent_log(), {}).fit();
  write_small_store(folder.path() / "snapshots.h5", 4, 20);
  Study study(folder.path(), one_band, {.trainer = trainer}, silent_log(), {});
  study.begin_at(folder.path() / "model.elrom");

  study.fit(folder.path() / "candidate.elrom");

  EXPECT_EQ(model::BundleReader(folder.path() / "candidate.elrom").info().cases.size(), 20u);
  const auto stages = timing()["stages"];
  for (const auto* stage : {"screen", "search"}) {
    EXPECT_EQ(stages[stage]["computed"], 0) << stage;
    EXPECT_GT(stages[stage]["reused"], 0) << stage;
  }
  // Five builds of the model go on from five that are known; those of cross-validation are all known.
  const auto fields = 2;
  EXPECT_EQ(stages["build"]["computed"], 5 * fields);
  const auto accuracy =
      nlohmann::json::parse(model::BundleReader(folder.path() / "candidate.elrom").info().accuracy_json);
  EXPECT_EQ(accuracy["pressure"]["known"].size(), 16u);
}

// A model of reused plans is another one than a model of all cases' own.
TEST_F(SmallStudy, ARunAfterRetrainingMakesItsOwnPlan) {
  auto one_band = settings("networks");
  one_band.bands.edges = {1e-9};
  Study(folder.path(), one_band, {.trainer = trainer}, silent_log(), {}).fit();
  write_small_store(folder.path() / "snapshots.h5", 4, 20);
  {
    Study study(folder.path(), one_band, {.trainer = trainer}, silent_log(), {});
    study.begin_at(folder.path() / "model.elrom");
    study.fit(folder.path() / "candidate.elrom");
  }

  Study(folder.path(), one_band, {.trainer = trainer}, silent_log(), {}).fit();

  EXPECT_EQ(timing()["stages"]["model"]["reused"], 0);
  EXPECT_GT(timing()["stages"]["search"]["computed"], 0);
}

}  // namespace
}  // namespace elrom::study
