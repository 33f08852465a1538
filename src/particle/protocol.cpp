#include "elrom/particle/protocol.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"

namespace elrom::particle {
namespace {

using Vector = Eigen::Array3d;
constexpr double two_pi = 2 * std::numbers::pi;

Vector cross(const Vector& a, const Vector& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}

double drawn(base::Random& random, const Range& range) { return random.uniform(range.low, range.high); }

Vector along(double sine, double cosine, double phi) {
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

// The source's: both angles uniform, so directions crowd at the poles.
Vector source_direction(base::Random& random) {
  const double phi = random.uniform(0, two_pi);
  const double theta = random.uniform(0, std::numbers::pi);
  return along(std::sin(theta), std::cos(theta), phi);
}

Vector any_direction(base::Random& random) {
  const double cosine = random.uniform(-1, 1);
  return along(std::sqrt((1 - cosine) * (1 + cosine)), cosine, random.uniform(0, two_pi));
}

// Normal of an impact point uniform on the disc across `direction`.
Vector any_impact(base::Random& random, const Vector& direction) {
  const double sine_squared = random.uniform();
  const double phi = random.uniform(0, two_pi);
  const Vector helper = std::abs(direction.x()) < 0.6 ? Vector(1, 0, 0) : Vector(0, 1, 0);
  const Vector across = cross(direction, helper).matrix().normalized().array();
  return std::sqrt(1 - sine_squared) * direction +
         std::sqrt(sine_squared) * (std::cos(phi) * across + std::sin(phi) * cross(direction, across));
}

struct OnePair {
  Vector velocity_1, velocity_2, spin_1 = Vector::Zero(), spin_2 = Vector::Zero(), normal;
  double diameter_1, diameter_2, overlap = 0;
};

OnePair draw(const Protocol& protocol, base::Random random) {
  OnePair pair;
  const bool source = protocol.kind == ProtocolKind::document;
  pair.diameter_1 = drawn(random, protocol.diameter_1);
  pair.diameter_2 = drawn(random, protocol.diameter_2);
  double speed = 0;
  while (speed == 0) {  // of equal velocities, which never meet
    const double speed_1 = drawn(random, protocol.speed), speed_2 = drawn(random, protocol.speed);
    pair.velocity_1 = speed_1 * (source ? source_direction(random) : any_direction(random));
    pair.velocity_2 = speed_2 * (source ? source_direction(random) : any_direction(random));
    speed = (pair.velocity_1 - pair.velocity_2).matrix().norm();
  }
  const Vector direction = (pair.velocity_1 - pair.velocity_2) / speed;
  pair.normal = source ? direction : any_impact(random, direction);
  if (source && protocol.approach_time)
    pair.overlap = std::max(0.0, (pair.diameter_1 + pair.diameter_2) / 2 - speed * *protocol.approach_time);
  if (protocol.spin_speed > 0) {
    pair.spin_1 = random.uniform(0, 2 * protocol.spin_speed / pair.diameter_1) * any_direction(random);
    pair.spin_2 = random.uniform(0, 2 * protocol.spin_speed / pair.diameter_2) * any_direction(random);
  }
  return pair;
}

void expect(bool holds, const char* what, const std::string& found, const char* expected) {
  if (!holds) throw UsageError(Problem{.what = what, .found = found, .expected = expected});
}

void expect_range(const Range& range, const char* what, double least) {
  expect(range.low >= least && range.low <= range.high &&
                 range.high<HUGE_VAL, what, fmt::format("{} to {}", range.low, range.high), least> 0
             ? "more than 0, low before high"
             : "low before high");
}

}  // namespace

void Protocol::check() const {
  constexpr double least_size = 1e-12;  // m; smaller than an atom
  expect_range(speed, "wrong range of speeds, in m/s", 0);
  expect(speed.high > 0, "spheres that do not move never meet",
         fmt::format("speeds {} to {} m/s", speed.low, speed.high), "a highest speed of more than 0");
  expect_range(diameter_1, "wrong diameter of sphere 1, in m", least_size);
  expect_range(diameter_2, "wrong diameter of sphere 2, in m", least_size);
  for (const double density : {density_1, density_2})
    expect(density > 0 && density < HUGE_VAL, "wrong density, in kg/m3", fmt::format("{}", density),
           "more than 0");
  expect(spin_speed >= 0 && spin_speed < HUGE_VAL, "wrong surface speed of spins, in m/s",
         fmt::format("{}", spin_speed), "0 or more");
  if (kind == ProtocolKind::document)
    expect(spin_speed == 0, "protocol document has no spins", fmt::format("{} m/s", spin_speed),
           "none, or protocol general");
  if (!approach_time) return;
  expect(kind == ProtocolKind::document, "only protocol document starts spheres overlapped",
         fmt::format("an approach time with protocol {}", protocol_names.name(kind)), "protocol document");
  expect(*approach_time > 0 && *approach_time < HUGE_VAL, "wrong approach time, in s",
         fmt::format("{}", *approach_time), "more than 0");
}

Pairs draw_pairs(const Protocol& protocol, std::uint64_t seed, std::size_t first, std::size_t count) {
  Pairs pairs(count);
  const auto stream = base::Seed(seed).derive("pairs");
  for (std::size_t k = 0; k < count; ++k) {
    const auto pair = draw(protocol, base::Random(stream.derive(first + k)));
    const auto i = static_cast<Eigen::Index>(k);
    pairs.before.velocity_1.row(i) = pair.velocity_1;
    pairs.before.velocity_2.row(i) = pair.velocity_2;
    pairs.before.spin_1.row(i) = pair.spin_1;
    pairs.before.spin_2.row(i) = pair.spin_2;
    pairs.normal.row(i) = pair.normal;
    pairs.diameter_1[i] = pair.diameter_1;
    pairs.diameter_2[i] = pair.diameter_2;
    pairs.overlap[i] = pair.overlap;
  }
  pairs.density_1 = protocol.density_1;
  pairs.density_2 = protocol.density_2;
  return pairs;
}

}  // namespace elrom::particle
