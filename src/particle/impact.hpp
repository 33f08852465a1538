#pragma once
// Pairs at contact, in the lanes: what every collision model begins and ends with. Internal.

#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/contact_law.hpp"
#include "lanes.hpp"

namespace elrom::particle {

/// How the spheres of a few pairs meet.
struct Impact {
  Mask closing;             ///< the others get no impulse
  Lane reduced_mass;        ///< kg
  Lane radius_1, radius_2;  ///< m
  Lane normal_speed;        ///< v_n, m/s; positive where they close in
  Lane slip_speed;          ///< c, m/s
  LaneVector normal;        ///< n, from 1 to 2
  LaneVector slip;          ///< unit vector of the slip of 2 on 1; zero where there is none
  LaneVector velocity;      ///< of 2 relative to 1, m/s
  LaneVector spin;          ///< r1 w1 + r2 w2, m/s
};

[[nodiscard]] Impact impact_of(const Pairs& pairs, std::size_t first);

/// What a collision does to the relative motion.
struct Exchange {
  LaneVector impulse;  ///< on sphere 2, N s; sphere 1 gets its opposite
  LaneVector moment;   ///< N s: sphere i gets the angular impulse r_i moment
};

/// Shortened to where it adds no energy, and none at all where the spheres do not close in; written for both
/// spheres. A share s of it adds s (v . J + S . M) + s^2 (J^2 + 5/2 M^2) / (2 m12).
void give(const Impact& impact, const Exchange& exchange, Impulses& impulses, std::size_t first);

}  // namespace elrom::particle
