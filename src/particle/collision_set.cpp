#include "elrom/particle/collision_set.hpp"

namespace elrom::particle {
namespace {

void cut(Components& velocity, double cap) {
  const Scalars speed = velocity.square().rowwise().sum().sqrt();
  const Scalars factor = (speed > cap).select(cap / speed, 1.0);
  velocity.colwise() *= factor;
}

}  // namespace

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
