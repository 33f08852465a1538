#include "elrom/networks/search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "elrom/base/error.hpp"
#include "proposals.hpp"
#include "support/recording_log.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::networks {
namespace {

// A smooth bowl over the hyperparameters with its least value near rate 3e-3, 64 units, 2 layers, batch 64.
double bowl(const Hyperparameters& h) {
  const double rate = std::log10(h.learning_rate / 3e-3), units = std::log2(h.n_units / 64.0),
               batch = std::log2(h.batch_size / 64.0);
  return 0.1 + 0.05 * rate * rate + 0.01 * units * units + 0.005 * batch * batch +
         0.02 * std::abs(h.n_layers - 2);
}

// Stands for a trainer: falls towards the bowl's value within the epochs it is given.
class FakeTrainer {
 public:
  TrainingResult operator()(const Hyperparameters& h, base::Seed seed, TrainingMonitor* monitor) {
    ++calls;
    base::Random random(seed);
    const double goal = bowl(h) * (1 + noise * random.normal());
    TrainingResult result;
    for (int epoch = 0; epoch < max_epochs; ++epoch) {
      result.validation_mse = goal + std::exp(-epoch / 5.0);
      result.epochs = epoch + 1;
      if (monitor != nullptr && !monitor->keep_going(epoch + 1, result.validation_mse)) {
        result.pruned = true;
        break;
      }
    }
    if (calls == kill_at) throw Interrupted("killed");
    if (diverges && h.learning_rate > 1e-3) result.validation_mse = NAN, result.diverged = true;
    return result;
  }
  int calls = 0, kill_at = -1, max_epochs = 54;
  double noise = 0.02;
  bool diverges = false;
};

SearchSettings settings_for(const std::string& algorithm, int trials = 40) {
  SearchSettings settings;
  settings.algorithm = algorithm;
  settings.trials = trials;
  settings.max_epochs = 54;
  settings.confirm = 3;
  settings.confirm_seeds = 2;
  return settings;
}

SearchResult run(FakeTrainer& trainer, const SearchSettings& settings, const SearchContext& context = {}) {
  return search(std::ref(trainer), settings, SearchSpace(settings), context);
}

class EveryAlgorithm : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryAlgorithm, EndsNearTheBestWithExactlyItsDistinctTrials) {
  FakeTrainer trainer;
  const auto settings = settings_for(GetParam());

  const auto result = run(trainer, settings);

  std::set<std::string> distinct;
  for (const auto& trial : result.trials)
    if (trial.i_seed == 0) distinct.insert(SearchSpace::key(trial.hyperparameters));
  EXPECT_EQ(distinct.size(), 40u);
  EXPECT_EQ(trainer.calls, 40 + 3 * 2);
  EXPECT_LT(bowl(result.best), 0.15) << "the bowl spans 0.1 to 0.3";
}

TEST_P(EveryAlgorithm, SameSeedSameWinner) {
  FakeTrainer first, second;

  EXPECT_EQ(run(first, settings_for(GetParam())).best, run(second, settings_for(GetParam())).best);
}

TEST_P(EveryAlgorithm, DivergedTrialsLose) {
  FakeTrainer trainer;
  trainer.diverges = true;
  test::RecordingLog log;

  const auto result = run(trainer, settings_for(GetParam(), 30), {.name = "pressure", .log = &log});

  EXPECT_THAT(log.text(),
              ::testing::MatchesRegex("search pressure: [0-9]+ of 36 trainings diverged and are lost\n"));
  EXPECT_LE(result.best.learning_rate, 1e-3);
  EXPECT_TRUE(std::isfinite(result.validation_mse));
}

TEST_P(EveryAlgorithm, KilledSearchResumesToTheSameWinnerAndRepeatsNoTrial) {
  const auto path = std::filesystem::temp_directory_path() /
                    ("search_" + GetParam() + std::to_string(::getpid()) + ".sqlite");
  FakeTrainer whole, killed, resumed;
  const auto expected = run(whole, settings_for(GetParam()));
  killed.kill_at = 17;
  {
    TrialStore store(path);
    EXPECT_THROW((void)run(killed, settings_for(GetParam()), {.digest = "d", .store = &store}), Interrupted);
  }
  TrialStore store(path);

  const auto result = run(resumed, settings_for(GetParam()), {.digest = "d", .store = &store});

  EXPECT_EQ(result.best, expected.best);
  EXPECT_EQ(result.validation_mse, expected.validation_mse);
  EXPECT_EQ(result.n_replayed, 16u);
  EXPECT_EQ(resumed.calls, whole.calls - 16);
  std::filesystem::remove(path);
}

INSTANTIATE_TEST_SUITE_P(Search, EveryAlgorithm,
                         ::testing::Values("direct", "sobol_bobyqa", "sbplx", "crs2", "random"));

// What the search knows of networks is their struct; any other one is searched and kept the same way.
struct Boosting {
  int n_rounds = 10;
  double learning_rate = 0.3;
  bool operator==(const Boosting&) const = default;
  static constexpr std::array names{"n_rounds", "learning_rate"};
  static constexpr const char* trial_table = "boosting_trials";
};

SearchResultOf<Boosting> search_boosting(TrialStoreOf<Boosting>* store, int& calls, int kill_at = -1) {
  const SearchSpaceOf<Boosting> space(
      {}, {{"learning_rate", log_bins({0.01, 1}, 10)}, {"n_rounds", whole_bins({5, 54})}});
  const auto evaluate = [&](const Boosting& h, base::Seed, TrainingMonitor* monitor) {
    TrialOutcome outcome;
    for (int round = 1; round <= h.n_rounds && !outcome.pruned; ++round) {
      outcome.epochs = round;
      outcome.validation_mse = std::abs(std::log10(h.learning_rate / 0.1)) + 1.0 / round;
      outcome.pruned = !monitor->keep_going(round, outcome.validation_mse);
    }
    if (++calls == kill_at) throw Interrupted("killed");
    return outcome;
  };
  return search(evaluate, settings_for("sobol_bobyqa"), space, {.digest = "d", .store = store});
}

TEST(Search, AnyStructOfHyperparametersIsSearchedPrunedKeptAndResumed) {
  const test::TemporaryFolder folder;
  const auto path = folder / "search.sqlite";
  int whole = 0, killed = 0, resumed = 0;
  const auto expected = search_boosting(nullptr, whole);
  {
    TrialStore networks(path);  // of networks, in the same file
    networks.add("d", "pressure", "k", {.value = 1});
    TrialStoreOf<Boosting> store(path);
    EXPECT_THROW((void)search_boosting(&store, killed, 17), Interrupted);
  }
  TrialStoreOf<Boosting> store(path);

  const auto result = search_boosting(&store, resumed);

  EXPECT_EQ(result.best, expected.best);
  EXPECT_EQ(result.n_replayed, 16U);
  EXPECT_EQ(resumed, whole - 16);
  EXPECT_NEAR(std::log10(result.best.learning_rate), -1, 0.15);
  EXPECT_GT(result.best.n_rounds, 20);
  EXPECT_TRUE(std::ranges::any_of(result.trials, &TrialOf<Boosting>::pruned));
  ASSERT_EQ(store.searches().size(), 1U);
  EXPECT_EQ(store.searches()[0].trials.size(), result.trials.size());
  EXPECT_EQ(TrialStore(path).searches().at(0).trials.size(), 1U) << "tables of their own";
}

/// Numbers of rounds found nearly the best, of three with these errors.
std::vector<int> near_best_of(std::array<double, 3> errors) {
  const SearchSpaceOf<Boosting> space({}, {{"n_rounds", whole_bins({1, 3})}});
  auto settings = settings_for("direct", 3);
  settings.confirm = 0;
  const auto found = search(
      [&](const Boosting& h, base::Seed, TrainingMonitor*) {
        TrialOutcome outcome;
        outcome.validation_mse = errors[static_cast<std::size_t>(h.n_rounds - 1)];
        return outcome;
      },
      settings, space, SearchContextOf<Boosting>{});
  EXPECT_EQ(found.validation_mse, *std::ranges::min_element(errors));
  std::vector<int> rounds;
  for (const auto& h : found.near_best) rounds.push_back(h.n_rounds);
  return rounds;
}

TEST(Search, WhatComesWithinATenthOfTheBestIsNearIt) {
  EXPECT_THAT(near_best_of({2, 1, 3}), ::testing::ElementsAre(2));
  EXPECT_THAT(near_best_of({1.09, 1, 1.11}), ::testing::ElementsAre(1, 2));
  EXPECT_THAT(near_best_of({1, 1.01, 3}), ::testing::ElementsAre(1, 2)) << "whichever of two equals wins";
  EXPECT_THAT(near_best_of({1.01, 1, 3}), ::testing::ElementsAre(1, 2));
  EXPECT_THAT(near_best_of({0, 1, 2}), ::testing::ElementsAre(1)) << "an error of zero has none beside it";
}

TEST(SearchSpace, OnlyNumbersOfTheStructAreSearched) {
  const auto space = [](const char* name) {
    return SearchSpaceOf<Hyperparameters>({}, {{name, whole_bins({1, 3})}});
  };
  EXPECT_EQ(space("n_layers").decode(std::vector{1.0}).n_layers, 3);
  EXPECT_THROW(space("n_trees"), std::logic_error);
  EXPECT_THROW(space("activation"), std::logic_error);
}

TEST(Search, PruningSavesEpochsAndNeverTheFirstEight) {
  FakeTrainer pruned, whole;
  auto settings = settings_for("random");

  const auto with = run(pruned, settings);
  settings.prune = false;
  const auto without = run(whole, settings);

  const auto epochs = [](const SearchResult& result) {
    int sum = 0;
    for (const auto& trial : result.trials) sum += trial.epochs;
    return sum;
  };
  EXPECT_LT(epochs(with), 0.7 * epochs(without));
  for (std::size_t i = 0; i < 8; ++i) EXPECT_FALSE(with.trials[i].pruned);
}

TEST(Search, OneTrialIsEnough) {
  FakeTrainer trainer;

  EXPECT_EQ(run(trainer, settings_for("direct", 1)).trials.size(), 1u);
}

TEST(Search, ASpaceOfOnePointEndsWithoutItsTrialsSpent) {
  FakeTrainer trainer;
  auto settings = settings_for("crs2", 10);
  settings.learning_rate = {1e-3, 1e-3};
  settings.n_layers = {2, 2};
  settings.n_units = {32, 32};
  settings.batch_size = {64, 64};

  const auto result = run(trainer, settings);

  EXPECT_EQ(trainer.calls, 1);
  EXPECT_EQ(result.best.n_units, 32);
}

TEST(Search, UnknownAlgorithmIsRefused) {
  FakeTrainer trainer;
  EXPECT_THROW((void)run(trainer, settings_for("simplex")), UsageError);
}

TEST(SearchSpace, DecodesTheCornersToTheRanges) {
  const SearchSpace space(settings_for("direct"));

  const auto low = space.decode(std::vector<double>{0, 0, 0, 0}),
             high = space.decode(std::vector<double>{1, 1, 1, 1});

  EXPECT_DOUBLE_EQ(low.learning_rate, 3e-4);
  EXPECT_EQ(low.n_units, 16);
  EXPECT_DOUBLE_EQ(high.learning_rate, 2e-2);
  EXPECT_EQ(high.n_layers, 3);
  EXPECT_EQ(high.n_units, 256);
  EXPECT_EQ(high.batch_size, 256);
  EXPECT_EQ(high.weight_decay, 0) << "searched only when asked for";
}

TEST(SearchSpace, NotANumberDecodesToTheMiddle) {
  const SearchSpace space(settings_for("direct"));

  EXPECT_EQ(space.decode(std::vector<double>{NAN, 0.5, 0.5, 0.5}),
            space.decode(std::vector<double>{0.5, 0.5, 0.5, 0.5}));
}

TEST(TrialStore, RefusesAFileOfAnotherKind) {
  const auto path =
      std::filesystem::temp_directory_path() / ("store_" + std::to_string(::getpid()) + ".sqlite");
  {
    std::FILE* file = std::fopen(path.c_str(), "w");
    std::fputs("this is no database, but it is long enough to be read as one", file);
    std::fclose(file);
  }

  EXPECT_THROW(TrialStore{path}, InputError);
  std::filesystem::remove(path);
}

TEST(TrialStore, TrialsReadBackExactly) {
  const auto path =
      std::filesystem::temp_directory_path() / ("trials_" + std::to_string(::getpid()) + ".sqlite");
  Trial trial{.hyperparameters = {.learning_rate = 1.0 / 3, .activation = model::Activation::silu},
              .i_seed = 2,
              .value = 0.1 + 0.2,
              .epochs = 7,
              .pruned = true,
              .diverged = true,
              .rungs = {0.3, 1.0 / 7}};
  {
    TrialStore store(path);
    store.add("s", "pressure", "k", trial);
  }
  const TrialStore store(path);

  const auto found = store.find("s", "k", 2);

  ASSERT_TRUE(found);
  EXPECT_EQ(found->hyperparameters, trial.hyperparameters);
  EXPECT_EQ(found->value, trial.value);
  EXPECT_EQ(found->rungs, trial.rungs);
  EXPECT_EQ(found->epochs, 7);
  EXPECT_TRUE(found->pruned);
  EXPECT_TRUE(found->diverged);
  EXPECT_FALSE(store.find("s", "k", 1));
  ASSERT_EQ(store.searches().size(), 1u);
  EXPECT_EQ(store.searches()[0].name, "pressure");
  for (const auto* end : {"", "-wal", "-shm"}) std::filesystem::remove(path.string() + end);
}

}  // namespace
}  // namespace elrom::networks
