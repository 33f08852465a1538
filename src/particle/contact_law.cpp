#include "elrom/particle/contact_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/particle/pairs.hpp"

namespace elrom::particle {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr double least_restitution = 1e-6;

double log_of(double restitution) { return std::log(std::clamp(restitution, least_restitution, 1.0)); }

// sqrt(pi^2 + ln^2 e)
double half_turn(double restitution) { return std::hypot(std::numbers::pi, log_of(restitution)); }

void expect(bool holds, const char* what, double found, const char* expected) {
  if (!holds)
    throw UsageError(Problem{.what = what, .found = fmt::format("{}", found), .expected = expected});
}

double effective_radius(const Ball& one, const Ball& two) {
  return 0.5 * one.diameter * two.diameter / (one.diameter + two.diameter);
}

double reduced_mass(const Ball& one, const Ball& two) {
  const double mass_1 = sphere_mass(one.diameter, one.density);
  const double mass_2 = sphere_mass(two.diameter, two.density);
  return mass_1 / (mass_1 + mass_2) * mass_2;
}

// 1/E* = 2 (1 - nu^2) / E of two equal materials
double effective_modulus(const ContactLaw& law) {
  return law.youngs_modulus / (2 * (1 - law.poisson_ratio * law.poisson_ratio));
}

double shear_modulus(const ContactLaw& law) { return law.youngs_modulus / (2 * (1 + law.poisson_ratio)); }

}  // namespace

void ContactLaw::check() const {
  expect(restitution >= 0 && restitution <= 1, "wrong coefficient of restitution", restitution, "0 to 1");
  expect(friction >= 0 && friction < HUGE_VAL, "wrong coefficient of friction", friction, "0 or more");
  expect(sticking_restitution() >= 0 && sticking_restitution() <= 1, "wrong tangential restitution",
         sticking_restitution(), "0 to 1");
  if (kind == LawKind::linear) {
    expect(stiffness > 0 && stiffness < HUGE_VAL, "wrong stiffness of a linear contact, in N/m", stiffness,
           "more than 0");
    return;
  }
  expect(youngs_modulus > 0 && youngs_modulus < HUGE_VAL, "wrong Young's modulus, in Pa", youngs_modulus,
         "more than 0");
  expect(poisson_ratio > -1 && poisson_ratio <= 0.5, "wrong Poisson's ratio", poisson_ratio, "-1 to 0.5");
}

std::string ContactLaw::text() const {
  const auto stiff = kind == LawKind::linear
                         ? fmt::format("{:.4g} N/m", stiffness)
                         : fmt::format("E {:.4g} Pa, nu {:.4g}", youngs_modulus, poisson_ratio);
  return fmt::format("{}, e {:.4g}, mu {:.4g}, {}", law_names.name(kind), restitution, friction, stiff);
}

PairContact::PairContact(const ContactLaw& law, const Ball& one, const Ball& two)
    : kind(law.kind),
      restitution(law.restitution),
      reduced_mass(particle::reduced_mass(one, two)),
      distance((one.diameter + two.diameter) / 2) {
  const double turn = half_turn(restitution);
  if (kind == LawKind::linear) {
    stiffness = law.stiffness;
    const double tau = duration(0);
    damping = -2 * reduced_mass * log_of(restitution) / tau;
    const double slip_mass = 2.0 / 7.0 * reduced_mass;  // of the surfaces of solid spheres
    const double slip_turn = half_turn(law.sticking_restitution()) / tau;
    tangential_stiffness = slip_mass * slip_turn * slip_turn;
    tangential_damping = -2 * slip_mass * log_of(law.sticking_restitution()) / tau;
    return;
  }
  const double root_radius = std::sqrt(effective_radius(one, two));
  const double share = -log_of(restitution) / turn;
  stiffness = 4.0 / 3.0 * effective_modulus(law) * root_radius;
  damping = std::sqrt(5.0) * share * std::sqrt(reduced_mass * stiffness);
  // G* = G / (2 (2 - nu)) of two equal materials.
  tangential_stiffness = 8 * shear_modulus(law) / (2 * (2 - law.poisson_ratio)) * root_radius;
  tangential_damping = 2 * std::sqrt(5.0 / 6.0) * share * std::sqrt(reduced_mass * tangential_stiffness);
}

double PairContact::duration(double normal_speed) const {
  const double turn = half_turn(restitution);
  if (kind == LawKind::linear) return std::sqrt(reduced_mass / stiffness) * turn;
  return 2.9432 * greatest_overlap(normal_speed) / normal_speed * turn / std::numbers::pi;
}

double PairContact::greatest_overlap(double normal_speed) const {
  if (kind == LawKind::linear) return normal_speed * std::sqrt(reduced_mass / stiffness);
  return std::pow(1.25 * reduced_mass * normal_speed * normal_speed / stiffness, 0.4);
}

double PairContact::spring_energy(double overlap) const {
  if (kind == LawKind::linear) return 0.5 * stiffness * overlap * overlap;
  return 0.4 * stiffness * overlap * overlap * std::sqrt(overlap);
}

double PairContact::tangent_stiffness(double overlap) const {
  return kind == LawKind::linear ? stiffness : 1.5 * stiffness * std::sqrt(overlap);
}

double stiffness_for_overlap(double share, double speed, const Ball& one, const Ball& two) {
  const double speed_a_length = speed / (share * std::min(one.diameter, two.diameter));
  return reduced_mass(one, two) * speed_a_length * speed_a_length;
}

double StepTimes::step() const { return std::min(0.2 * std::min({rayleigh, hertz, cundall}), linear / 20); }

StepTimes step_times(const ContactLaw& law, double speed, const Ball& one, const Ball& two) {
  const PairContact contact(law, one, two);
  const double overlap = contact.greatest_overlap(speed);
  StepTimes times{never, never, 2 * std::sqrt(contact.reduced_mass / contact.tangent_stiffness(overlap)),
                  never};
  if (law.kind == LawKind::linear) {
    times.linear = contact.duration(speed);
    return times;
  }
  const auto rayleigh = [&](const Ball& ball) {
    return std::numbers::pi * ball.diameter / 2 * std::sqrt(ball.density / shear_modulus(law)) /
           (0.1631 * law.poisson_ratio + 0.8766);
  };
  const double modulus = effective_modulus(law);
  times.rayleigh = std::min(rayleigh(one), rayleigh(two));
  times.hertz = 2.87 * std::pow(contact.reduced_mass * contact.reduced_mass /
                                    (effective_radius(one, two) * modulus * modulus * speed),
                                0.2);
  return times;
}

}  // namespace elrom::particle
