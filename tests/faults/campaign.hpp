#pragma once
// The fault campaign: what is done to ELROM's programs and files, and how much of it they survive.

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"

namespace elrom::faults {

/// n of n.
struct Tally {
  std::size_t passed = 0, of = 0;
  std::vector<std::string> failures;  ///< what went wrong, one line each (the first few)
  std::string skipped;                ///< why nothing was done; empty: it was
  /// Programs among the passed that a library took along, by library
  std::map<std::string, std::size_t> died_in;

  /// @param failure what to say when it did not pass
  void count(bool good, const std::string& failure);
  /// As many at once, of which so many passed.
  void count(std::size_t n_good, std::size_t n, const std::string& failure);
  [[nodiscard]] bool clean() const { return passed == of; }
};

/// Where things are, and a small study to do harm to.
struct Workshop {
  std::filesystem::path programs;  ///< folder of elrom-data, elrom-train, elrom-predict
  std::filesystem::path preload;   ///< failing_calls library
  std::filesystem::path source;    ///< the repository
  std::filesystem::path folder;    ///< for files
  std::filesystem::path fuzzers;   ///< folder of libFuzzer's programs; need not exist
  std::size_t n_fuzz = 0;          ///< inputs for them
  bool small = false;
  base::Seed seed{20231};

  [[nodiscard]] std::string program(const std::string& name) const { return (programs / name).string(); }
  [[nodiscard]] std::size_t times(std::size_t full, std::size_t few) const { return small ? few : full; }
  [[nodiscard]] std::filesystem::path mesh() const { return folder / "mesh.h5"; }
  /// Shipped training cases, (n).
  [[nodiscard]] std::vector<std::string> case_files(std::size_t n, std::size_t first = 0) const;
  [[nodiscard]] std::vector<std::string> import_command(const std::filesystem::path& store,
                                                        const std::vector<std::string>& files) const;
  /// A study that trains in a tenth of a second ...
  static constexpr const char* quick = R"(
method = "pod_gp"
effort = "quick"
seed = 5
threads = 1
[peers]
methods = ["linear", "pod_rbf"]
folds = 3
)";
  /// ... all fields without networks, or two fields with them, in half a second: LibTorch starts slowly.
  static constexpr const char *no_networks = "networks = false\n",
                              *two_fields = "[fields]\nnames = [\"gas_velocity_z\", \"pressure\"]\n";
  /// A study with a store of n_cases on a coarse mesh. @param settings its study.toml
  void make_study(const std::filesystem::path& study, std::size_t n_cases,
                  const std::string& settings = std::string(quick) + no_networks) const;
  [[nodiscard]] std::vector<std::string> train_command(const std::filesystem::path& study) const;
  [[nodiscard]] std::vector<std::string> predict_command(const std::filesystem::path& bundle,
                                                         const std::filesystem::path& output) const;
  /// A set of collisions, in blocks of 8192 pairs.
  [[nodiscard]] std::vector<std::string> collide_command(const std::filesystem::path& output,
                                                         std::size_t n_pairs = 9000) const;
};

/// kill -9 at random moments of import, training, prediction, the start of an OpenFOAM run and the making of
/// collisions; afterwards old or new state, and the next run ends.
Tally kills(const Workshop& workshop);
/// kill -9 at random moments of a training of networks, again and again until it ends: its bundle is byte for
/// byte that of a run left alone, and so are its trials.
Tally network_kills(const Workshop& workshop);
/// Bundles, stores and exports cut at many lengths are refused with exit status 3 or an InputError.
Tally truncations(const Workshop& workshop);
/// Every byte of a bundle, changed, is found by its digests.
Tally flipped_bytes(const Workshop& workshop);
/// Every case of the shipped ones, every slip between two units, one at a time.
Tally unit_mistakes(const Workshop& workshop);
/// The table of tests/stability.
Tally hard_cases(const Workshop& workshop);
/// The n-th write, truncation, fsync or rename fails (full disk, broken disk), or a write is short;
/// afterwards old or new state, and no program dies by a signal.
Tally failing_writes(const Workshop& workshop);
/// The same when the n-th allocation fails.
Tally failing_allocations(const Workshop& workshop);
/// The same on a file system that is really full; skipped where none may be mounted.
Tally disk_full(const Workshop& workshop);
/// Two programs on one store or study: one works, the other waits or refuses; readers see whole files.
Tally two_at_once(const Workshop& workshop);

/// The state of a store after trouble: its cases when it opens and reads whole, -1 when it is not there, -2
/// when broken.
[[nodiscard]] long store_state(const std::filesystem::path& store);
/// Every prediction in a folder, which need not exist, opens and reads whole.
[[nodiscard]] bool predictions_whole(const std::filesystem::path& folder);
/// A set of collisions, which need not exist, opens and reads whole.
[[nodiscard]] bool collisions_whole(const std::filesystem::path& path);

}  // namespace elrom::faults
