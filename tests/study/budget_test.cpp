#include "elrom/study/budget.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/study/study.hpp"
#include "study_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::study {
namespace {

CostModel model_of(double seconds_per_fit) {
  return {.seconds_per_fit = seconds_per_fit, .n_fields = 9, .n_threads = 2};
}

TEST(Budget, LevelsCostMoreOneAfterTheOther) {
  const auto levels = budget_levels({}, model_of(1));

  ASSERT_EQ(levels.size(), 6u);
  for (std::size_t i = 1; i < levels.size(); ++i) EXPECT_GT(levels[i].seconds, levels[i - 1].seconds);
  EXPECT_EQ(levels.front().settings.method, "pod_rbf");
  EXPECT_EQ(levels[1].seconds, 9 * (1 + 3.0 * 2 / 2));  // a fit, and 6 of the folds on 2 threads
  EXPECT_TRUE(levels.back().settings.peers.networks);
  EXPECT_FALSE(levels.front().settings.peers.networks);
}

TEST(Budget, ManyCasesHaveAsManyFoldsForTheirIntervalsAsForTheContest) {
  auto model = model_of(1);
  model.n_cases = 128;

  EXPECT_EQ(budget_levels({}, model)[1].seconds, 9 * (1 + 2.0 * 2 / 2));
}

TEST(Budget, WhatWasRuledOutStaysOut) {
  Settings settings;
  settings.peers.networks = false;
  settings.peers.folds = 3;

  for (const auto& level : budget_levels(settings, model_of(1))) {
    EXPECT_FALSE(level.settings.peers.networks);
    EXPECT_LE(level.settings.peers.folds, 3);
  }
}

TEST(Budget, TheDearestLevelThatFitsIsTakenAndNetworksComeAfterAModelThatStands) {
  const auto levels = budget_levels({}, model_of(1));

  EXPECT_EQ(next_level(levels, 1, {}), 0u) << "too short for any: a model that takes next to nothing";
  EXPECT_EQ(next_level(levels, 1.2 * levels[4].seconds, {}), 3u) << "nothing stands yet: what is sure to fit";
  EXPECT_EQ(next_level(levels, 2.1 * levels[4].seconds, {}), 4u);
  EXPECT_EQ(next_level(levels, 1e6, {}), 4u);
  EXPECT_EQ(next_level(levels, 1.2 * levels[4].seconds, {.settings = {}, .done = 0}), 4u);
  EXPECT_EQ(next_level(levels, 1.2 * levels[5].seconds, {.settings = {}, .done = 4}), 5u);
  EXPECT_EQ(next_level(levels, 0.6 * levels[5].seconds, {.settings = {}, .done = 4}), 5u) << "it may fit";
  EXPECT_EQ(next_level(levels, 0.4 * levels[5].seconds, {.settings = {}, .done = 4}), std::nullopt);
  EXPECT_EQ(next_level(levels, 0.6 * levels[1].seconds, {.settings = {}, .done = 0}), 1u);
  EXPECT_EQ(next_level(levels, 1e6, {.settings = {}, .done = 5}), std::nullopt);
}

TEST(Budget, WhatFitsGoesByThePaceSoFar) {
  const auto levels = budget_levels({}, model_of(1));

  EXPECT_EQ(next_level(levels, 0.6 * levels[5].seconds, {.settings = {}, .done = 4, .pace = 0.5}), 5u);
  EXPECT_EQ(next_level(levels, 0.6 * levels[5].seconds, {.settings = {}, .done = 4, .pace = 2}),
            std::nullopt);
  EXPECT_EQ(next_level(levels, 1.2 * levels[3].seconds, {.settings = {}, .done = 1}), 3u)
      << "and a dearer one without networks goes before them";
}

TEST(Budget, WhatWasLeftOutIsSaidWithItsTime) {
  auto model = model_of(10);
  model.networks_had_no_part = true;
  const auto levels = budget_levels({}, model);

  const auto words = left_out(levels, {.settings = {}, .done = 4, .pace = 0.5});

  ASSERT_EQ(words.size(), 1u);
  EXPECT_THAT(words.front(), ::testing::HasSubstr("networks too"));
  EXPECT_THAT(words.front(), ::testing::HasSubstr(base::duration(0.5 * levels[5].seconds)));
  EXPECT_THAT(words.front(), ::testing::HasSubstr("expect nothing of it"));
}

TEST(Budget, WhenNothingWasLeftOutThatIsSaid) {
  const auto words = left_out(budget_levels({}, model_of(1)), {.settings = {}, .done = 5});

  ASSERT_EQ(words.size(), 1u);
  EXPECT_THAT(words.front(), ::testing::HasSubstr("nothing was left out"));
  EXPECT_THAT(words.front(), ::testing::HasSubstr("more cases"));
}

/// Levels of the shipped kind that take these seconds.
std::vector<BudgetLevel> levels_of(std::vector<double> seconds) {
  auto levels = budget_levels({}, model_of(1));
  for (std::size_t i = 0; i < levels.size(); ++i) levels[i].seconds = seconds[i];
  return levels;
}

TEST(Budget, ALevelThatIsNotDoneInTimeIsStoppedAndTheOneBeforeStands) {
  std::vector<std::string> trained;
  const auto begin = std::chrono::steady_clock::now();

  const auto run = run_within(0.5, levels_of({0, 0.01, 0.02, 0.03, 0.04, 0.05}), silent_log(), {},
                              [&](const Settings& own, const std::stop_token& stop) {
                                trained.push_back(own.peers.networks ? "networks" : "without");
                                while (own.peers.networks && !stop.stop_requested())
                                  std::this_thread::sleep_for(std::chrono::milliseconds(1));
                                if (stop.stop_requested()) throw Interrupted("stopped");
                              });

  EXPECT_EQ(trained, (std::vector<std::string>{"without", "networks"})) << "and nothing is done once more";
  EXPECT_FALSE(run.settings.peers.networks);
  EXPECT_EQ(run.done, 4u);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

TEST(Budget, TimeThatALevelLeftOverGoesToTheNextThatFits) {
  std::vector<bool> with_networks;

  const auto run = run_within(
      10, levels_of({0, 1, 2, 3, 4, 40}), silent_log(), {},
      [&](const Settings& own, const std::stop_token&) { with_networks.push_back(own.peers.networks); });

  EXPECT_EQ(with_networks, (std::vector<bool>{false, true})) << "ten times as fast as expected: they fit";
  EXPECT_EQ(run.done, 5u);
}

TEST(Budget, WhenWhatWasAskedForIsNotDoneInTimeASimplePeerAnswers) {
  Settings asked;
  asked.method = "networks";
  const auto levels = budget_levels(asked, model_of(1));
  int n = 0;

  const auto run =
      run_within(0.05, {levels[0]}, silent_log(), {}, [&](const Settings& own, const std::stop_token& stop) {
        ++n;
        while (own.method == "networks" && !stop.stop_requested())
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        if (stop.stop_requested()) throw Interrupted("stopped");
      });

  EXPECT_EQ(run.settings.method, "pod_rbf");
  EXPECT_EQ(run.done, std::nullopt);
  EXPECT_EQ(n, 2);
}

TEST(Budget, ACallerWhoStopsIsNotTakenForTheClock) {
  std::stop_source source;
  source.request_stop();

  EXPECT_THROW(
      (void)run_within(60, {budget_levels({}, model_of(1)).front()}, silent_log(), source.get_token(),
                       [](const Settings&, const std::stop_token&) { throw Interrupted("stopped"); }),
      Interrupted);
}

TEST(Budget, TheCostModelTimesAFitOfThisStudy) {
  const test::TemporaryFolder folder;
  write_small_store(folder / "snapshots.h5", 15);

  const auto model = cost_model(folder.path(), read_settings(folder / "study.toml"), silent_log());

  EXPECT_GT(model.seconds_per_fit, 0);
  EXPECT_EQ(model.n_fields, 2u);
}

}  // namespace
}  // namespace elrom::study
