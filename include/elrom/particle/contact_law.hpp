#pragma once
// What two spheres do to each other while they overlap: soft-sphere laws and the times that belong to them.
//
// Linear spring and damper, or Hertz with Tsuji's damping; both with a tangential spring that remembers
// (Mindlin's for Hertz), limited by Coulomb's friction (Cundall & Strack 1979; Tsuji et al. 1992). Everything
// that two solid spheres do is the motion of one body of mass m12 = m1 m2 / (m1 + m2), since
// the surface's velocity at the contact needs only the sum r1 w1 + r2 w2 (pair_solver.hpp).
//
// Thread rule: pure functions.

#include <optional>
#include <string>

#include "elrom/base/enum_names.hpp"

namespace elrom::particle {

enum class LawKind { linear, hertz };
inline constexpr base::EnumNames<LawKind, 2> law_names{
    "contact law", {{LawKind::linear, "linear"}, {LawKind::hertz, "hertz"}}};

/// Two spheres of one material. A law of kind linear needs `stiffness`, one of kind hertz the elastic constants.
struct ContactLaw {
  LawKind kind = LawKind::linear;
  double restitution = 0.9;  ///< e of the normal velocity, 0 to 1
  double friction = 0;       ///< Coulomb's mu
  std::optional<double>
      tangential_restitution;   ///< of a contact that sticks, 0 to 1; missing: as `restitution`
  double stiffness = 0;         ///< N/m, linear
  double youngs_modulus = 1e9;  ///< Pa, Hertz
  double poisson_ratio = 0.3;   ///< Hertz
  bool operator==(const ContactLaw&) const = default;

  [[nodiscard]] double sticking_restitution() const { return tangential_restitution.value_or(restitution); }
  /// @throws UsageError for what no material has: e outside 0 to 1, a negative friction or stiffness ...
  void check() const;
  /// "linear, e 0.9, mu 0.3, 1.2e+06 N/m"
  [[nodiscard]] std::string text() const;
};

/// The law between two given spheres.
///
/// Force on sphere 2 along the normal: stiffness d^p + damping d^q d', with the overlap d and its rate d';
/// linear: p = 1, q = 0; Hertz: p = 3/2, q = 1/4. Tangential spring: tangential_stiffness d^s, s = 0 or 1/2;
/// its damper: tangential_damping d^q.
struct PairContact {
  PairContact(const ContactLaw& law, double diameter_1, double density_1, double diameter_2,
              double density_2);

  double reduced_mass;  ///< m12, kg
  double distance;      ///< R = r1 + r2, m
  double stiffness;     ///< K, or 4/3 E* sqrt(R*) with R* = r1 r2 / (r1 + r2)
  double
      damping;  ///< linear: -2 m12 ln e / tau; Hertz: sqrt(5) b sqrt(m12 K) (Antypov & Elliott 2011, exact for any speed)
  double
      tangential_stiffness;  ///< linear: from the sticking restitution and tau; Hertz: 8 G* sqrt(R*) (Mindlin)
  double tangential_damping;

  /// Of a contact that begins at this normal speed, s. Linear: tau = sqrt(m12/K) sqrt(pi^2 + ln^2 e).
  /// Hertz: 2.9432 (m12^2 / (k^2 v))^0.2 with k = 4/5 K without damping (Landau & Lifshitz), longer with it.
  [[nodiscard]] double duration(double normal_speed) const;
  /// Greatest overlap of an undamped head-on contact, m.
  [[nodiscard]] double greatest_overlap(double normal_speed) const;

  LawKind kind;
  double restitution;
};

/// Stiffness, N/m, at which the fastest central collision overlaps by this share of the smaller diameter.
[[nodiscard]] double stiffness_for_overlap(double share, double speed, double diameter_1, double density_1,
                                           double diameter_2, double density_2);

/// Times that bound the step of an explicit simulation, s.
///   rayleigh  pi r sqrt(rho / G) / (0.1631 nu + 0.8766), the smaller sphere
///   hertz     2.87 (m*^2 / (R* E*^2 v))^0.2
///   cundall   2 sqrt(m12 / k), k the stiffness at the greatest overlap
///   contact   linear: tau; Hertz: its duration
/// What a law does not know (a linear one has no moduli) is infinite.
struct StepTimes {
  double rayleigh, hertz, cundall, contact;
  /// 0.2 min(rayleigh, hertz, cundall), and contact / 20 of a linear law.
  [[nodiscard]] double step(LawKind kind) const;
};
[[nodiscard]] StepTimes step_times(const ContactLaw& law, double speed, double diameter_1, double density_1,
                                   double diameter_2, double density_2);

}  // namespace elrom::particle
