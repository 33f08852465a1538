#pragma once
// A folder into which a solver exports its results, and a store that follows it.
//
// A file is finished when two looks find the same size and time of change. What is finished and not in the
// store (by digest) is imported with all checks, together with what else is finished; what is wrong or
// suspicious moves to a folder, with the reason beside it (<name>.reason.txt). Imported files stay, and so
// does what is no export by its ending or its first line.

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/ingest/import_checked.hpp"

namespace elrom::ingest {

struct WatchOptions {
  std::filesystem::path folder;
  std::filesystem::path refused;   ///< made when it is needed; empty: folder/refused
  ImportOptions import;            ///< but for its files
  std::set<std::string> accepted;  ///< kinds of findings that refuse nothing
  /// Called before finished files are imported. Empty: nothing is.
  std::function<void()> before_import = {};
};

struct Refusal {
  std::filesystem::path file;  ///< where it was
  std::string reason;
};

/// What came of one look.
struct Look {
  std::vector<std::string> added;  ///< cases, in the order in which they entered the store
  std::vector<Refusal> refused;
  std::vector<std::filesystem::path> left_alone;  ///< files that are no exports, each once
  std::size_t n_unfinished = 0;                   ///< files that may still be written to
  std::size_t n_cases = 0;                        ///< in the store; 0: none were added
};

/// Nothing is lost by a crash: the store is replaced whole, and files are known by digest afterwards.
/// Thread rule: one thread at a time.
class Watcher {
 public:
  /// @throws InputError when the folder is none; UsageError for a new store without a mesh
  explicit Watcher(WatchOptions options);
  /// @throws InputError for a store that cannot be read or added to, UsageError while another process writes
  ///         to it, SystemError, Interrupted; the store is then as it was, and another look tries again
  Look look(Log& log, const std::stop_token& stop = {});

 private:
  struct State {
    std::uintmax_t size = 0;
    std::filesystem::file_time_type changed;
    bool operator==(const State&) const = default;
  };
  using States = std::map<std::filesystem::path, State>;

  [[nodiscard]] States list(std::vector<std::filesystem::path>& others) const;
  [[nodiscard]] bool is_ours(const std::filesystem::path& path) const;
  [[nodiscard]] static State state_of(const std::filesystem::path& path);
  [[nodiscard]] std::vector<std::filesystem::path> finished(const States& now,
                                                            std::vector<std::filesystem::path>& others);
  void read_store();
  [[nodiscard]] Refusal put_aside(const Refusal& refusal, Log& log) const;

  WatchOptions options_;
  States before_;                         //!< at the last look
  States settled_;                        //!< known to be in the store, or not to be moved
  std::set<std::filesystem::path> told_;  //!< that they are no exports
  std::set<std::string> in_store_;        //!< digests
};

}  // namespace elrom::ingest
