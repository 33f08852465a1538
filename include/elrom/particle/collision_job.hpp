#pragma once
// The making of a set of collisions as a piece of long work: blocks that are kept, progress, and going on
// after a crash.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "elrom/base/log.hpp"
#include "elrom/particle/collision_set.hpp"

namespace elrom::particle {

struct CollisionJob {
  Protocol protocol;
  ContactLaw law;
  std::uint64_t seed = 1;
  std::size_t n_pairs = 60000;
  PairSolverOptions options;
  std::optional<double> speed_cap;  ///< m/s
  /// @throws UsageError for what nobody can ask for, before anything is computed
  void check() const;
};

struct CollisionRun {
  CollisionSet set;
  std::size_t n_reused = 0;  ///< pairs found done
  double seconds = 0;        ///< of the others
};

/// Makes the set and writes its file. Blocks of pairs are kept in the folder ".<name>.blocks" beside it until
/// the file is there: the same job goes on from them and gives the same bytes.
/// @throws UsageError as check(), and when another process makes this file; Interrupted; SystemError
[[nodiscard]] CollisionRun make_collision_file(const std::filesystem::path& path, const CollisionJob& job,
                                               const std::map<std::string, std::string>& provenance, Log& log,
                                               const std::stop_token& stop);

}  // namespace elrom::particle
