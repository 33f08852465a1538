#include "impact.hpp"

namespace elrom::particle {
namespace {

constexpr double mass_of_cube = 0.52359877559829887;  // pi / 6
constexpr double largest = 1e150;                     // its square is finite
constexpr double no_slip = 1e-12;                     // of the closing speed

Lane mass(const Lane& diameter, const Lane& density) {
  return mass_of_cube * density * diameter * diameter * diameter;
}

LaneVector only(const Mask& use, const LaneVector& vector) {
  return select(use, vector, LaneVector{0.0, 0.0, 0.0});
}

Lane harmless_share(const Impact& impact, const Exchange& exchange) {
  const Lane taken = -dot(impact.velocity, exchange.impulse) - dot(impact.spin, exchange.moment);
  const Lane given =
      (0.5 * dot(exchange.impulse, exchange.impulse) + 1.25 * dot(exchange.moment, exchange.moment)) /
      impact.reduced_mass;
  return max(select(given > taken, taken / given, Lane(1.0)), Lane(0.0));
}

}  // namespace

Impact impact_of(const Pairs& pairs, std::size_t first) {
  Impact impact;
  const Lane diameter_1 = load(pairs.diameter_1, first), diameter_2 = load(pairs.diameter_2, first);
  impact.radius_1 = 0.5 * diameter_1;
  impact.radius_2 = 0.5 * diameter_2;
  const Lane mass_1 = mass(diameter_1, load(pairs.density_1, first));
  const Lane mass_2 = mass(diameter_2, load(pairs.density_2, first));
  impact.reduced_mass = mass_1 / (mass_1 + mass_2) * mass_2;
  impact.normal = load_vector(pairs.normal, first);
  impact.velocity = load_vector(pairs.before.velocity_2, first) - load_vector(pairs.before.velocity_1, first);
  impact.spin = impact.radius_1 * load_vector(pairs.before.spin_1, first) +
                impact.radius_2 * load_vector(pairs.before.spin_2, first);
  impact.normal_speed = -dot(impact.velocity, impact.normal);
  const LaneVector slip =
      impact.velocity + impact.normal_speed * impact.normal - cross(impact.spin, impact.normal);
  // What rounding left of a head-on pair has no direction.
  const Lane slip_speed = sqrt(dot(slip, slip));
  impact.slip_speed = select(slip_speed > no_slip * impact.normal_speed, slip_speed, Lane(0.0));
  // Comparisons are false for what is not a number.
  impact.closing =
      impact.normal_speed > 0 && slip_speed < largest && dot(impact.velocity, impact.velocity) < largest &&
      dot(impact.spin, impact.spin) < largest && impact.reduced_mass > 0 && impact.reduced_mass < largest;
  impact.slip = only(impact.closing && impact.slip_speed > 0, (1 / impact.slip_speed) * slip);
  return impact;
}

void give(const Impact& impact, const Exchange& exchange, Impulses& impulses, std::size_t first) {
  const Lane share = harmless_share(impact, exchange);
  const LaneVector on_2 = only(impact.closing, share * exchange.impulse);
  const LaneVector moment = only(impact.closing, share * exchange.moment);
  store(on_2, impulses.linear_2, first);
  store(Lane(-1.0) * on_2, impulses.linear_1, first);
  store(impact.radius_1 * moment, impulses.angular_1, first);
  store(impact.radius_2 * moment, impulses.angular_2, first);
}

}  // namespace elrom::particle
