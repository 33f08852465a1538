#pragma once
// A set of collisions: what was drawn, what came out, by which law. The file `collisions.h5`
// (data/FORMATS.md, kind "elrom-collisions").

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "elrom/particle/contact_law.hpp"
#include "elrom/particle/pair_solver.hpp"
#include "elrom/particle/protocol.hpp"

namespace elrom::particle {

struct CollisionSet {
  Protocol protocol;
  ContactLaw law;
  std::uint64_t seed = 1;
  std::optional<double>
      speed_cap;  ///< m/s: velocities after the contact are cut to this length; the source's 100
  Pairs pairs;
  Parting parting;
  std::map<std::string, std::string> provenance = {};  ///< program, created ...

  [[nodiscard]] std::size_t size() const { return pairs.size(); }
};

/// How many pairs judge: the last ones of a set of n, from which no model learns.
[[nodiscard]] std::size_t n_test_pairs(std::size_t n, double share = 0.05);

/// Draws and collides pairs first to first + count; the same pairs whatever the blocks. @throws Interrupted
[[nodiscard]] CollisionSet make_collisions(const Protocol& protocol, const ContactLaw& law,
                                           std::uint64_t seed, std::size_t first, std::size_t count,
                                           const PairSolverOptions& options,
                                           std::optional<double> speed_cap = {},
                                           const std::stop_token& stop = {});

/// @throws SystemError when the disk does not take it
void write_collisions(const std::filesystem::path& path, const CollisionSet& set);
/// @throws InputError for another kind, a newer major version,
/// shapes that do not fit, values that are not finite
[[nodiscard]] CollisionSet read_collisions(const std::filesystem::path& path);

}  // namespace elrom::particle
