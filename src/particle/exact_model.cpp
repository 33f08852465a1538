#include "elrom/particle/exact_model.hpp"

#include "impact.hpp"

namespace elrom::particle {

ExactModel::ExactModel(const ContactLaw& law)
    : restitution_(law.restitution), friction_(law.friction), sticking_(law.sticking_restitution()) {
  law.check();
}

void ExactModel::impulses(const Pairs& pairs, Impulses& impulses) const {
  impulses.resize(pairs.size());
  for (std::size_t first = 0; first < pairs.size(); first += lane_width) {
    const auto impact = impact_of(pairs, first);
    const Lane normal = impact.reduced_mass * (1 + restitution_) * impact.normal_speed;
    const Lane sticking = impact.reduced_mass * (2.0 / 7.0 * (1 + sticking_)) * impact.slip_speed;
    const LaneVector friction = min(friction_ * normal, sticking) * impact.slip;
    // Lever arms -r2 n and r1 n, opposite forces: both moments point the same way.
    give(impact, {normal * impact.normal - friction, cross(impact.normal, friction)}, impulses, first);
  }
}

// The law, which the bundle keeps, is all there is.
void ExactModel::write(io::TensorFile&) const {}

}  // namespace elrom::particle
