#include "elrom/particle/collision_set.hpp"

#include <algorithm>
#include <cmath>

namespace elrom::particle {
namespace {

void cut(Components& velocity, double cap) {
  const Scalars speed = velocity.square().rowwise().sum().sqrt();
  const Scalars factor = (speed > cap).select(cap / speed, 1.0);
  velocity.colwise() *= factor;
}

}  // namespace

std::size_t n_test_pairs(std::size_t n, double share) {
  return std::min(
      n, std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share * static_cast<double>(n)))));
}

CollisionSet make_collisions(const Protocol& protocol, const ContactLaw& law, std::uint64_t seed,
                             std::size_t first, std::size_t count, const PairSolverOptions& options,
                             std::optional<double> speed_cap, const std::stop_token& stop) {
  protocol.check();
  CollisionSet set{.protocol = protocol, .law = law, .seed = seed, .speed_cap = speed_cap};
  set.pairs = draw_pairs(protocol, seed, first, count);
  set.parting = collide(set.pairs, law, options, stop);
  if (speed_cap) {
    cut(set.parting.after.velocity_1, *speed_cap);
    cut(set.parting.after.velocity_2, *speed_cap);
  }
  return set;
}

}  // namespace elrom::particle
