#include "elrom/study/gate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/study/study.hpp"
#include "study_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::study {
namespace {

/// A study of 15 cases, 3 of them held out, with a bundle for each method asked for.
class Gate : public ::testing::Test {
 protected:
  Gate() { write_small_store(folder_ / "snapshots.h5", 15); }

  [[nodiscard]] std::filesystem::path bundle(const std::string& method, bool hold_out = true) const {
    std::vector<std::string> lines{"effort=quick", "method=" + method, "peers.networks=false"};
    if (!hold_out) lines.emplace_back("split.held_out=[]");
    const auto path = folder_ / (method + ".elrom");
    Study study(folder_.path(), read_settings(folder_ / "study.toml", lines), {}, silent_log(), {});
    (void)study.fit(path);
    return path;
  }
  [[nodiscard]] GateVerdict judged(const std::string& present, const std::string& candidate,
                                   bool hold_out = true, const GateSettings& settings = {}) const {
    const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");
    const auto before = bundle(present, hold_out), after = bundle(candidate, hold_out);
    const auto all = store.find("*"), train = store.find("train_*");
    const GateCases cases{store, hold_out ? train : all,
                          hold_out ? store.find("load_*") : std::vector<std::size_t>()};
    const auto verdict = judge(before, after, cases, settings, 1);
    if (!verdict) throw std::runtime_error("no verdict");
    return *verdict;
  }

  test::TemporaryFolder folder_;
};

TEST_F(Gate, AModelThatIsFarWorseIsRefusedFieldByField) {
  const auto verdict = judged("linear", "nearest");

  EXPECT_FALSE(verdict.passed);
  EXPECT_EQ(verdict.judged_on, "held-out cases");
  EXPECT_EQ(verdict.cases.size(), 3u);
  EXPECT_GT(verdict.mean.after, verdict.mean.before);
  EXPECT_THAT(verdict.what_is_worse(), ::testing::Contains("pressure"));
}

TEST_F(Gate, TheOtherWayRoundItPasses) {
  const auto verdict = judged("nearest", "linear");

  EXPECT_TRUE(verdict.passed);
  EXPECT_LT(verdict.mean.after, verdict.mean.before);
  EXPECT_EQ(verdict.fields.front().change, Change::better);
}

TEST_F(Gate, TheSameModelIsTheSameInEveryField) {
  const auto verdict = judged("linear", "linear");

  EXPECT_TRUE(verdict.passed);
  for (const auto& one : verdict.fields) {
    EXPECT_EQ(one.change, Change::same) << one.field;
    EXPECT_EQ(one.before, one.after);
    EXPECT_EQ(one.scatter, 0);
  }
}

TEST_F(Gate, AToleranceLetsALossPass) {
  const auto strict = judged("linear", "nearest");
  const double most = std::max(strict.fields[0].after - strict.fields[0].before,
                               strict.fields[1].after - strict.fields[1].before);

  EXPECT_TRUE(judged("linear", "nearest", true, {.tolerance = 1.01 * most}).passed);
  EXPECT_FALSE(judged("linear", "nearest", true, {.tolerance = 0.99 * most / 10}).passed)
      << "ten tolerances, whatever the scatter";
}

TEST_F(Gate, ItsErrorIsTheNrmseOverHeldOutCasesAgainstTheMeanOfTheTrainingCases) {
  const auto verdict = judged("nearest", "linear");
  const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");
  const auto rows = store.find("load_*"), others = store.find("train_*");
  const model::Predictor predictor(folder_ / "linear.elrom");
  const auto inputs = store.inputs(rows);
  const auto n_cells = static_cast<Eigen::Index>(store.mesh().n_cells());
  double expected = 0;
  for (std::size_t f = 0; f < predictor.fields().size(); ++f) {
    const MatrixD truth = store.read(predictor.fields()[f].name, rows).cast<double>();
    const Eigen::RowVectorXd mean =
        store.read(predictor.fields()[f].name, others).cast<double>().colwise().mean();
    MatrixD predicted(truth.rows(), truth.cols());
    for (Eigen::Index i = 0; i < truth.rows(); ++i) {
      std::vector<float> values(predictor.size());
      model::Predictor::Scratch scratch;
      predictor.predict({inputs.row(i).data(), 3}, values, {}, scratch);
      for (Eigen::Index c = 0; c < n_cells; ++c)
        predicted(i, c) = values[f * static_cast<std::size_t>(n_cells) + static_cast<std::size_t>(c)];
    }
    expected += (predicted - truth).norm() / (truth.rowwise() - mean).norm() / 2;  // of two fields
  }

  EXPECT_NEAR(verdict.mean.after, expected, 1e-6 * expected);
  EXPECT_GT(expected, 0);
  EXPECT_LT(expected, 1);
}

// d = q - p, and the other cases' errors of the better model stand for the scatter of the truth.
TEST_F(Gate, WithoutRepeatedRunsTheScatterIsFromTheBetterModelsErrors) {
  const auto verdict = judged("nearest", "linear");
  const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");
  const auto rows = store.find("load_*");
  const MatrixD truth = store.read("pressure", rows).cast<double>();
  const auto predicted = [&](const char* file) {
    const model::Predictor predictor(folder_ / file, {.fields = {"pressure"}});
    MatrixF values(truth.rows(), truth.cols());
    model::Predictor::Scratch scratch;
    const auto inputs = store.inputs(rows);
    for (Eigen::Index i = 0; i < truth.rows(); ++i)
      predictor.predict({inputs.row(i).data(), 3}, {values.row(i).data(), predictor.size()}, {}, scratch);
    return MatrixD(values.cast<double>());
  };
  const MatrixD before = predicted("nearest.elrom"), after = predicted("linear.elrom");
  const MatrixD difference = after - before, errors = truth - after;
  double variance = 0;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j)
      if (i != j) variance += 4 * std::pow(difference.row(i).dot(errors.row(j)), 2) / 2;
  const double squares = std::abs((after - truth).squaredNorm() - (before - truth).squaredNorm());
  const auto& one = verdict.fields.front();
  ASSERT_EQ(one.field, "pressure");

  EXPECT_EQ(verdict.scatter_from, "errors");
  EXPECT_NEAR(one.scatter / (one.before - one.after), std::sqrt(variance) / squares, 1e-4);
}

TEST_F(Gate, WithoutHeldOutCasesTheCommonCasesOfTheCrossValidationsJudge) {
  const auto verdict = judged("nearest", "linear", false);
  const auto accuracy =
      nlohmann::json::parse(model::BundleReader(folder_ / "linear.elrom").info().accuracy_json);
  double squares = 0;
  for (const auto& error : accuracy["pressure"]["squared_errors"]) squares += error.get<double>();
  const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");
  const MatrixD values = store.read("pressure", store.find("*")).cast<double>();
  const Eigen::RowVectorXd mean = values.colwise().mean();

  EXPECT_TRUE(verdict.passed);
  EXPECT_EQ(verdict.judged_on, "cross-validation");
  EXPECT_EQ(verdict.scatter_from, "cases");
  EXPECT_EQ(verdict.cases.size(), 15u);
  EXPECT_NEAR(verdict.fields.front().after, std::sqrt(squares) / (values.rowwise() - mean).norm(), 1e-6);
  EXPECT_FALSE(judged("linear", "nearest", false).passed);
}

TEST_F(Gate, BundlesWithoutErrorsByCaseAreComparedByTheirMeanError) {
  const auto before = bundle("linear", false), after = bundle("nearest", false);
  const auto strip = [](const std::filesystem::path& path) {
    const model::BundleReader reader(path);
    model::Bundle copy{.info = reader.info(),
                       .mesh = reader.mesh(),
                       .guard = reader.guard(),
                       .furnace = {},
                       .models = {},
                       .uncertainty = {}};
    auto accuracy = nlohmann::json::parse(copy.info.accuracy_json);
    for (auto& field : accuracy) field.erase("squared_errors");
    copy.info.accuracy_json = accuracy.dump();
    for (const auto& info : copy.info.fields) copy.models[info.name] = reader.model(info.name);
    copy.write(path);
  };
  strip(before);
  const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");

  const auto verdict = judge(before, after, {store, store.find("*"), {}}, {}, 1);

  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->scatter_from, "none");
  EXPECT_TRUE(std::isnan(verdict->mean.scatter));
  EXPECT_FALSE(verdict->passed);
}

TEST_F(Gate, RepeatedRunsTellTheScatterAndAreNotScored) {
  auto furnace = small_furnace();
  furnace.held_out = {"load_*", "rep*"};
  furnace.repeats = {"rep*"};
  write_small_store(folder_ / "snapshots.h5", 0, 0, furnace);
  const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");
  const auto load = store.find("load_4").front();
  {
    field::SnapshotWriter writer(folder_ / "snapshots.h5", store.mesh(), store.schema(), store.fields());
    for (const auto* name : {"rep1", "rep2"}) {
      field::Snapshot run{.record = store.cases()[load], .fields = {}};
      run.record.inputs.name = name;
      run.fields.resize(2, static_cast<Eigen::Index>(store.mesh().n_cells()));
      for (Eigen::Index f = 0; f < 2; ++f)
        run.fields.row(f) =
            store.read(store.fields()[static_cast<std::size_t>(f)].name, std::array{load}).array() +
            (name[3] == '1' ? 2.0F : -3.0F);
      writer.add(run);
    }
    writer.commit();
  }
  const auto after = bundle("linear"), before = bundle("nearest");
  const auto grown = field::SnapshotStore::open(folder_ / "snapshots.h5");
  auto held_out = grown.find("load_*");
  for (const auto row : grown.find("rep*")) held_out.push_back(row);

  const auto verdict = judge(before, after, {grown, grown.find("train_*"), held_out}, {}, 1);

  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->scatter_from, "repeated runs");
  EXPECT_THAT(verdict->cases, ::testing::ElementsAre("load_4", "load_9", "load_14"));
  EXPECT_GT(verdict->fields.front().scatter, 0);
}

TEST_F(Gate, CasesThatOneModelWasTrainedOnDoNotJudge) {
  const auto before = bundle("nearest", false);
  const auto after = bundle("linear");
  const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");

  const auto verdict = judge(before, after, {store, store.find("train_*"), store.find("load_*")}, {}, 1);

  ASSERT_TRUE(verdict);
  EXPECT_EQ(verdict->judged_on, "cross-validation");
  EXPECT_EQ(verdict->cases.size(), 12u) << "that both were trained on";
}

TEST_F(Gate, AnotherMeshCannotBeCompared) {
  const auto before = bundle("linear");
  std::filesystem::remove(folder_ / "snapshots.h5");
  write_small_store(folder_ / "snapshots.h5", 15);
  auto bundle_of_other_mesh = [&] {
    const model::BundleReader reader(before);
    model::Bundle copy{.info = reader.info(),
                       .mesh = reader.mesh(),
                       .guard = reader.guard(),
                       .furnace = {},
                       .models = {},
                       .uncertainty = {}};
    copy.mesh.centre.array() += 1;
    for (const auto& info : copy.info.fields) copy.models[info.name] = reader.model(info.name);
    copy.write(folder_ / "other.elrom");
    return folder_ / "other.elrom";
  };
  const auto store = field::SnapshotStore::open(folder_ / "snapshots.h5");

  EXPECT_FALSE(
      judge(bundle_of_other_mesh(), before, {store, store.find("train_*"), store.find("load_*")}, {}, 1));
}

TEST_F(Gate, ItsVerdictIsWrittenAsDocumented) {
  const auto json = nlohmann::json::parse(to_json(judged("linear", "nearest")));

  EXPECT_EQ(json["judged_on"], "held-out cases");
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["fields"][0]["field"], "pressure");
  EXPECT_EQ(json["fields"][0]["verdict"], "worse");
  for (const auto* key : {"before", "after", "scatter"})
    EXPECT_TRUE(json["fields"][0][key].is_number()) << key;
}

}  // namespace
}  // namespace elrom::study
