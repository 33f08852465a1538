#pragma once
// Every trial of every search, in one SQLite file (STUDY/search.sqlite; layout in data/FORMATS.md). A trial
// is committed when it ends, so that a killed run loses only the trials in flight; the search resumes by
// replaying what is stored.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "elrom/networks/trainer.hpp"

namespace elrom::networks {

struct Trial {
  Hyperparameters hyperparameters;
  int i_seed = 0;    ///< 0: the search itself; from 1: built again to confirm
  double value = 0;  ///< validation MSE, standardised units; when pruned: reached so far
  int epochs = 0;
  bool pruned = false;
  bool diverged = false;
  double seconds = 0;
  std::vector<double> rungs;  ///< best validation MSE up to each rung that the trial reached
};

/// Thread rule: every member from any thread.
class TrialStore {
 public:
  /// Creates the file when it is not there. @throws InputError
  /// when it is no trial store or of a newer version
  explicit TrialStore(const std::filesystem::path& path);
  ~TrialStore();
  TrialStore(const TrialStore&) = delete;
  TrialStore& operator=(const TrialStore&) = delete;

  /// @param search digest of everything a trial's value depends on beside its hyperparameters
  /// @param key of the hyperparameters (SearchSpace::key)
  [[nodiscard]] std::optional<Trial> find(const std::string& search, const std::string& key,
                                          int i_seed) const;
  /// @param name of the search for people: "pressure, 0.1 to 0.2"
  void add(const std::string& search, const std::string& name, const std::string& key, const Trial& trial);

  struct Search {
    std::string digest, name;
    std::vector<Trial> trials;  ///< in the order they ended
  };
  /// All searches, in the order of their first trials.
  [[nodiscard]] std::vector<Search> searches() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::networks
