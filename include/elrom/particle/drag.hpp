#pragma once
// Drag of a gas on a sphere, alone or among others.
//
// Among others the gas fills the share eps_f of space (voidage) and moves at u, its own speed between the
// spheres. A law gives K, the force on one sphere over the relative speed, in the form of the equations where
// the pressure gradient acts on gas and spheres by their shares of space (model A): the force on spheres in
// a volume is beta u = eps_s / V_p K u. Of a fixed bed, -dp/dz = beta u / eps_f.
//
// Thread rule: pure functions.

#include "elrom/base/enum_names.hpp"

namespace elrom::particle {

struct Gas {
  double density = 1.184;      ///< kg/m3; air at 25 degC
  double viscosity = 1.84e-5;  ///< Pa s
};

/// Drag coefficient: 24/Re (1 + 0.15 Re^0.687) below Re = 1000, 0.44 above
/// (Schiller & Naumann 1933).
[[nodiscard]] double schiller_naumann(double reynolds);

/// Drag over the gas's speed relative to a sphere, kg/s: 1/8 pi d^2 rho C_D |u|. In the limit of a resting
/// gas Stokes's 3 pi mu d.
[[nodiscard]] double drag_rate(double diameter, double relative_speed, const Gas& gas);

enum class DragLaw { stokes, schiller_naumann, wen_yu, ergun, gidaspow, syamlal };
inline constexpr base::EnumNames<DragLaw, 6> drag_names{"drag law",
                                                        {{DragLaw::stokes, "stokes"},
                                                         {DragLaw::schiller_naumann, "schiller_naumann"},
                                                         {DragLaw::wen_yu, "wen_yu"},
                                                         {DragLaw::ergun, "ergun"},
                                                         {DragLaw::gidaspow, "gidaspow"},
                                                         {DragLaw::syamlal, "syamlal"}}};
/// Whether a law asks for the voidage.
[[nodiscard]] constexpr bool needs_voidage(DragLaw law) { return law > DragLaw::schiller_naumann; }

/// K, kg/s. @param voidage eps_f, above 0; of no account to the first two laws
///   wen_yu    3/4 C_D eps_s eps_f rho |u| / d eps_f^-2.65, Re = eps_f rho |u| d / mu (Wen & Yu 1966)
///   ergun     150 eps_s^2 mu / (eps_f d^2) + 1.75 eps_s rho |u| / d (Ergun 1952), made for packed beds
///   gidaspow  from the one to the other by 1/2 + atan(262.5 (eps_s - 0.2)) / pi
///   syamlal   3/4 C_D eps_s eps_f rho |u| / (v_r^2 d), by terminal speeds (Syamlal & O'Brien 1987)
[[nodiscard]] double drag_rate(DragLaw law, double diameter, double relative_speed, double voidage,
                               const Gas& gas);

/// Superficial speed of the gas at which drag and pressure carry a bed of spheres, m/s.
/// @throws UsageError as terminal_speed(), and for a law that does not know voidage
[[nodiscard]] double minimum_fluidisation_speed(DragLaw law, double diameter, double density, double voidage,
                                                const Gas& gas, double gravity = 9.81);

/// Speed at which drag carries weight less buoyancy, m/s. @throws UsageError unless sizes and densities are
/// positive and the sphere is the denser one
[[nodiscard]] double terminal_speed(double diameter, double density, const Gas& gas, double gravity = 9.81);

}  // namespace elrom::particle
