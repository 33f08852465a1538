#pragma once
// Two-particle DEM: pairs of spheres from touching, through contact, to parting.
//
// Of a pair only the relative motion is integrated: x from 1 to 2, v = v2 - v1, S = r1 w1 + r2 w2 and the
// tangential spring's force f:
//   m12 v' = F_n n + F_t,  S' = -(5/2) (|x| / R) n x F_t / m12,  f' = -k_t c (transported with the normal),
// with the surface's velocity c = v_t - (|x| / R) S x n; lever arms sum to the distance, so that linear and
// angular momentum are conserved exactly whatever the step. A spring's force shrinks with its stiffness
// when the contact unloads, so that no contact gains energy (Thornton et al. 2013).
//
// Classical Runge-Kutta of fourth order with a step for each pair; the last one ends where the spheres part.
// Several pairs at once in the lanes of the processor, blocks of pairs on threads; results depend on
// neither. What a law lacks (friction) is not computed.

#include <cstddef>
#include <stop_token>

#include "elrom/particle/contact_law.hpp"
#include "elrom/particle/pairs.hpp"

namespace elrom::particle {

struct PairSolverOptions {
  /// Steps of a contact's own duration; more where the step rules of contact_law.hpp ask for it.
  int steps_per_contact = 64;
  /// A pair that has not parted by then (e = 0: never) goes on as one body along the normal.
  int most_steps = 100000;
  int n_threads = 1;
};

/// How the pairs parted.
struct Parting {
  Motion after;
  Scalars overlap;           ///< greatest, m
  Scalars duration;          ///< of the contact, s; 0 for pairs that never approached
  std::size_t n_stayed = 0;  ///< pairs that had not parted at most_steps
  double pair_steps = 0;     ///< integrated steps, all pairs
};

/// @throws Interrupted on `stop`
/// Thread rule: any thread; uses up to n_threads of its own.
[[nodiscard]] Parting collide(const Pairs& pairs, const ContactLaw& law,
                              const PairSolverOptions& options = {}, const std::stop_token& stop = {});

}  // namespace elrom::particle
