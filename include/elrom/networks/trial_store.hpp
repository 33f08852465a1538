#pragma once
// Every trial of every search, in one SQLite file (STUDY/search.sqlite; layout in data/FORMATS.md). A trial
// is committed when it ends, so that a killed run loses only the trials in flight; the search resumes by
// replaying what is stored. One file may hold trials of several structs of hyperparameters, a table each.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "elrom/networks/hyperparameters.hpp"

namespace elrom::networks {

/// @tparam H a struct of hyperparameters (hyperparameters.hpp), or NamedValues
template <class H>
struct TrialOf {
  H hyperparameters;
  int i_seed = 0;    ///< 0: the search itself; from 1: built again to confirm
  double value = 0;  ///< validation MSE, standardised units; when pruned: reached so far
  int epochs = 0;
  bool pruned = false;
  bool diverged = false;
  double seconds = 0;
  std::vector<double> rungs;  ///< best validation MSE up to each rung that the trial reached
};
using Trial = TrialOf<Hyperparameters>;

template <class H>
[[nodiscard]] TrialOf<H> typed(const TrialOf<NamedValues>& trial) {
  return {from_values<H>(trial.hyperparameters),
          trial.i_seed,
          trial.value,
          trial.epochs,
          trial.pruned,
          trial.diverged,
          trial.seconds,
          trial.rungs};
}

/// One table of the file, for hyperparameters of any struct. Thread rule: every member from any thread.
class TrialTable {
 public:
  /// @param defaults of the hyperparameters: their names and types, and what a column that an older file lacks
  /// stands for
  TrialTable(const std::filesystem::path& path, const std::string& table, NamedValues defaults);
  ~TrialTable();
  TrialTable(const TrialTable&) = delete;
  TrialTable& operator=(const TrialTable&) = delete;

  [[nodiscard]] std::optional<TrialOf<NamedValues>> find(const std::string& search, const std::string& key,
                                                         int i_seed) const;
  void add(const std::string& search, const std::string& name, const std::string& key,
           const TrialOf<NamedValues>& trial);

  template <class H>
  struct SearchOf {
    std::string digest, name;
    std::vector<TrialOf<H>> trials;  ///< in the order they ended
  };
  [[nodiscard]] std::vector<SearchOf<NamedValues>> searches() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Thread rule: every member from any thread.
template <class H>
class TrialStoreOf {
 public:
  /// Creates the file when it is not there. @throws InputError
  /// when it is no trial store or of a newer version
  explicit TrialStoreOf(const std::filesystem::path& path) : table_(path, H::trial_table, to_values(H{})) {}

  /// @param search digest of everything a trial's value depends on beside its hyperparameters
  /// @param key of the hyperparameters (SearchSpace::key)
  [[nodiscard]] std::optional<TrialOf<H>> find(const std::string& search, const std::string& key,
                                               int i_seed) const {
    const auto found = table_.find(search, key, i_seed);
    return found ? std::optional(typed<H>(*found)) : std::nullopt;
  }
  /// @param name of the search for people: "pressure, 0.1 to 0.2"
  void add(const std::string& search, const std::string& name, const std::string& key,
           const TrialOf<H>& trial) {
    table_.add(search, name, key,
               {to_values(trial.hyperparameters), trial.i_seed, trial.value, trial.epochs, trial.pruned,
                trial.diverged, trial.seconds, trial.rungs});
  }

  using Search = TrialTable::SearchOf<H>;
  /// All searches, in the order of their first trials.
  [[nodiscard]] std::vector<Search> searches() const {
    std::vector<Search> result;
    for (const auto& search : table_.searches()) {
      result.push_back({search.digest, search.name, {}});
      for (const auto& trial : search.trials) result.back().trials.push_back(typed<H>(trial));
    }
    return result;
  }

  [[nodiscard]] TrialTable& table() { return table_; }

 private:
  TrialTable table_;
};
using TrialStore = TrialStoreOf<Hyperparameters>;

}  // namespace elrom::networks
