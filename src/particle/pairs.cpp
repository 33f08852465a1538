#include "elrom/particle/pairs.hpp"

namespace elrom::particle {
namespace {

Components some(const Components& all, std::size_t first, std::size_t count) {
  return all.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count));
}

Scalars some(const Scalars& all, std::size_t first, std::size_t count) {
  return all.segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count));
}

}  // namespace

Motion::Motion(std::size_t n)
    : velocity_1(Components::Zero(static_cast<Eigen::Index>(n), 3)),
      velocity_2(velocity_1),
      spin_1(velocity_1),
      spin_2(velocity_1) {}

Pairs::Pairs(std::size_t n)
    : before(n),
      normal(before.velocity_1),
      diameter_1(Scalars::Zero(static_cast<Eigen::Index>(n))),
      diameter_2(diameter_1),
      density_1(diameter_1),
      density_2(diameter_1),
      overlap(diameter_1) {}

Motion slice(const Motion& motion, std::size_t first, std::size_t count) {
  Motion part;
  part.velocity_1 = some(motion.velocity_1, first, count);
  part.velocity_2 = some(motion.velocity_2, first, count);
  part.spin_1 = some(motion.spin_1, first, count);
  part.spin_2 = some(motion.spin_2, first, count);
  return part;
}

Pairs slice(const Pairs& pairs, std::size_t first, std::size_t count) {
  Pairs part;
  part.before = slice(pairs.before, first, count);
  part.normal = some(pairs.normal, first, count);
  part.diameter_1 = some(pairs.diameter_1, first, count);
  part.diameter_2 = some(pairs.diameter_2, first, count);
  part.density_1 = some(pairs.density_1, first, count);
  part.density_2 = some(pairs.density_2, first, count);
  part.overlap = some(pairs.overlap, first, count);
  return part;
}

}  // namespace elrom::particle
