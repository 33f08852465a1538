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

/// Two spheres of one material. A law of kind linear needs
/// `stiffness`, one of kind hertz the elastic constants.
struct ContactLaw {
  LawKind kind = LawKind::linear;
  double restitution = 0.9;  ///< e of the normal velocity, 0 to 1
  double friction = 0;       ///< Coulomb's mu
  /// Linear: of the surface's velocity in a contact that sticks, 0 to 1; missing: as `restitution`.
  std::optional<double> tangential_restitution;
  double stiffness = 0;         ///< N/m, linear
  double youngs_modulus = 1e9;  ///< Pa, Hertz
  double poisson_ratio = 0.3;   ///< Hertz
  bool operator==(const ContactLaw&) const = default;

  [[nodiscard]] double sticking_restitution() const { return tangential_restitution.value_or(restitution); }
  /// @throws UsageError for what no material has: e outside 0 to 1, a negative friction, no stiffness ...
  void check() const;
  /// "linear, e 0.9, mu 0.3, 1.2e+06 N/m"
  [[nodiscard]] std::string text() const;
};

/// A sphere of a pair.
struct Ball {
  double diameter, density;  ///< m, kg/m3
};

/// The law between two given spheres.
///
/// Force on sphere 2 along the normal: stiffness d^p + damping d^q d', with the overlap d
/// and its rate d'; linear: p = 1, q = 0; Hertz: p = 3/2, q = 1/4. Tangential spring:
/// tangential_stiffness d^s, s = 0 or 1/2; its damper: tangential_damping d^q. A
/// restitution below 1e-6 counts as 1e-6: a contact with e = 0 has no end.
struct PairContact {
  PairContact(const ContactLaw& law, const Ball& one, const Ball& two);

  LawKind kind;
  double restitution;
  double reduced_mass;  ///< m12, kg
  double distance;      ///< R = r1 + r2, m
  double stiffness;     ///< K; Hertz: 4/3 E* sqrt(R*), R* = r1 r2 / (r1 + r2)
  /// Linear: -2 m12 ln(e) / tau. Hertz: sqrt(5) b sqrt(m12 K), b = -ln e / sqrt(pi^2 + ln^2 e), which gives e
  /// at any speed (Antypov & Elliott 2011).
  double damping;
  /// Linear: so that a contact that sticks turns the slip round by its restitution in the time tau (2/7 K
  /// where both restitutions are equal). Hertz: 8 G* sqrt(R*) (Mindlin).
  double tangential_stiffness;
  double tangential_damping;

  /// Of a contact that begins at this normal speed, s. Linear: tau = sqrt(m12/K) sqrt(pi^2 + ln^2 e).
  /// Hertz: 2.9432 d_max / v without damping, and as much longer with it as a linear one.
  [[nodiscard]] double duration(double normal_speed) const;
  /// Of an undamped head-on contact, m. Linear: v sqrt(m12/K). Hertz: (5 m12 v^2 / (4 K))^(2/5).
  [[nodiscard]] double greatest_overlap(double normal_speed) const;
  /// Spring energy at this overlap, J.
  [[nodiscard]] double spring_energy(double overlap) const;
  /// d F / d overlap without damping, N/m.
  [[nodiscard]] double tangent_stiffness(double overlap) const;
};

/// Stiffness, N/m, at which a central collision at this relative
/// speed overlaps by this share of the smaller diameter.
[[nodiscard]] double stiffness_for_overlap(double share, double speed, const Ball& one, const Ball& two);

/// Times that bound the step of an explicit simulation, s. What a
/// law does not know (a linear one has no moduli) is infinite.
struct StepTimes {
  double rayleigh;  ///< pi r sqrt(rho / G) / (0.1631 nu + 0.8766), the smaller of the two
  double hertz;     ///< 2.87 (m12^2 / (R* E*^2 v))^0.2
  double cundall;   ///< 2 sqrt(m12 / k), k at the greatest overlap
  double linear;    ///< tau
  /// 0.2 min(rayleigh, hertz, cundall), and a twentieth of tau.
  [[nodiscard]] double step() const;
};
/// @param speed normal, relative, m/s
[[nodiscard]] StepTimes step_times(const ContactLaw& law, double speed, const Ball& one, const Ball& two);

}  // namespace elrom::particle
