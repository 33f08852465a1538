// Whatever carries hyperparameters carries every one of them.

#include "elrom/networks/hyperparameters.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <set>

#include "elrom/networks/search.hpp"
#include "elrom/networks/stage_files.hpp"
#include "support/changed_members.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::networks {
namespace {

std::vector<Hyperparameters> one_of_each() { return test::each_member_changed(Hyperparameters{}); }

TEST(Hyperparameters, AStageFileKeepsEachOfThem) {
  EXPECT_EQ(hyperparameters_of(to_file(one_of_each(), 0.5)), one_of_each());
}

TEST(Hyperparameters, TheTrialStoreKeepsEachOfThem) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "search.sqlite";
  for (const auto& h : one_of_each()) {
    const auto key = SearchSpace::key(h);
    TrialStore(path).add("digest", "name", key, {.hyperparameters = h});
    const auto found = TrialStore(path).find("digest", key, 0);
    ASSERT_TRUE(found.has_value());
    EXPECT_EQ(found->hyperparameters, h);
  }
  EXPECT_EQ(TrialStore(path).searches().at(0).trials.size(), one_of_each().size());
}

TEST(Hyperparameters, AStoreFromBeforeOneWasSearchedHoldsTrialsAtItsDefault) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "search.sqlite";
  const Hyperparameters h{.learning_rate = 0.1, .n_units = 7};
  TrialStore(path).add("digest", "name", SearchSpace::key(h), {.hyperparameters = h});
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  for (const auto* change :
       {"ALTER TABLE trials DROP COLUMN n_layers", "ALTER TABLE trials DROP COLUMN activation"})
    ASSERT_EQ(sqlite3_exec(database, change, nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(database);

  EXPECT_EQ(TrialStore(path).find("digest", SearchSpace::key(h), 0)->hyperparameters, h);
}

TEST(Hyperparameters, TheKeyTellsEachOfThemApart) {
  std::set<std::string> keys{SearchSpace::key({})};
  for (const auto& h : one_of_each()) keys.insert(SearchSpace::key(h));
  EXPECT_EQ(keys.size(), 1 + one_of_each().size());
}

TEST(Hyperparameters, EveryNumberIsSearchedWhenAllAre) {
  const SearchSpace space({.regularise = true});
  const auto low = space.decode(std::vector<double>(space.n_dimensions(), 0.0)),
             high = space.decode(std::vector<double>(space.n_dimensions(), 1.0));
  std::vector<std::string> texts;
  for_each_hyperparameter(low, [&](std::string_view, const auto& value) { texts.push_back(text_of(value)); });
  std::size_t i = 0;
  for_each_hyperparameter(high, [&](std::string_view name, const auto& value) {
    if constexpr (!std::is_enum_v<std::decay_t<decltype(value)>>) {
      EXPECT_NE(text_of(value), texts[i]) << name;
    }
    ++i;
  });
}

}  // namespace
}  // namespace elrom::networks
