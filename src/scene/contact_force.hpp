#pragma once
// Force between two spheres, or a sphere and a wall, by the contact laws of particle/contact_law.hpp; what
// PairContact computes with roots and logarithms is scaled here from one reference contact. Internal.

#include <algorithm>
#include <cmath>

#include "elrom/particle/contact_law.hpp"
#include "elrom/scene/particles.hpp"

namespace elrom::scene {

/// What a contact's stiffness and damping rest on.
struct ContactSizes {
  double reduced_mass;      ///< kg; of a sphere on a wall its own
  double effective_radius;  ///< r1 r2 / (r1 + r2), m; on a wall the sphere's own
};

/// The surfaces' motion at the contact.
struct ContactMotion {
  double overlap, closing;  ///< m, m/s
  Vec slip;                 ///< of 2 on 1, across the normal, m/s
};

template <particle::LawKind kind, bool rough>
class ContactForce {
 public:
  explicit ContactForce(const particle::ContactLaw& law)
      : reference_(law, ball, ball),
        friction_(law.friction),
        per_mass_(1 / reference_.reduced_mass),
        per_radius_(4 / ball.diameter) {}

  /// @return the force along the normal on sphere 2, N
  [[nodiscard]] double normal(const ContactSizes& sizes, const ContactMotion& motion) const {
    const double mass = sizes.reduced_mass * per_mass_;
    if constexpr (kind == particle::LawKind::linear) {
      return reference_.stiffness * motion.overlap + reference_.damping * std::sqrt(mass) * motion.closing;
    } else {
      const double radius = std::sqrt(sizes.effective_radius * per_radius_), root = std::sqrt(motion.overlap);
      return reference_.stiffness * radius * motion.overlap * root +
             reference_.damping * std::sqrt(mass * radius * root) * motion.closing;
    }
  }

  /// Friction on sphere 2 acts against the slip. @param spring its force, carried from step to step
  /// @param loaded overlap of the step before: a spring's force shrinks with its stiffness
  [[nodiscard]] Vec friction(const ContactSizes& sizes, const ContactMotion& motion, double normal,
                             double loaded, double dt, Vec& spring) const {
    double stiffness = reference_.tangential_stiffness,
           damping = reference_.tangential_damping * std::sqrt(sizes.reduced_mass * per_mass_);
    if constexpr (kind == particle::LawKind::hertz) {
      const double root = std::sqrt(sizes.effective_radius * per_radius_ * motion.overlap);
      stiffness *= std::sqrt(sizes.effective_radius * per_radius_) * std::sqrt(motion.overlap);
      damping *= std::sqrt(root);
      if (motion.overlap < loaded) spring = std::sqrt(motion.overlap / loaded) * spring;
    }
    const double most = friction_ * std::max(normal, 0.0);
    spring = cut(spring + (stiffness * dt) * motion.slip, most);
    return cut(spring + damping * motion.slip, most);
  }

 private:
  static constexpr particle::Ball ball{1e-3, 1000};  // m, kg/m3; effective radius d/4

  static Vec cut(const Vec& force, double most) {
    const double size = std::sqrt(dot(force, force));
    return size > most ? (most / size) * force : force;
  }

  particle::PairContact reference_;
  double friction_, per_mass_, per_radius_;
};

}  // namespace elrom::scene
