#pragma once
// Collisions in their own frame: few dimensionless numbers in, the impulse's components out.
//
// The relative motion of two solid spheres that collide rests on m12, R = r1 + r2 and the law alone
// (pair_solver.hpp). With v_n the closing speed, c the slip of the surfaces (across the normal, spins
// included), U = sqrt(v_n^2 + c^2) and o the spheres' own relative velocity across the normal:
//
//   angle    c / (v_n + c), 0 head-on to 1 grazing
//   speed    square root of U sqrt(m12 / (K R^(p-1))) / R, K and p of PairContact: how far a contact overlaps
//   orbit    o / U along the slip and beside it (n x slip), and (r1 w1 + r2 w2) . n / U: they turn the normal
//            and the slip while the contact lasts
//
// give, in units of m12 U, the impulse along the normal, against the slip and beside it, and the moments that
// turn the spheres, about n x slip and the slip (of hard spheres the same numbers as against and beside). One
// model thus serves all diameters, densities and mass ratios of its law. Without spins o is the slip; then
// the orbit is left out, and nothing points beside.
//
// Momentum is conserved exactly, since both spheres get the same impulse. An impulse that would add energy is
// shortened until it adds none.

#include <memory>

#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/regressor.hpp"

namespace elrom::particle {

/// What a regressor learns from.
struct FrameRecords {
  Table inputs;  ///< (n, 2): angle, speed; with spins (n, 5): and orbit
  Table
      targets;  ///< (n, 3): along, against, moment about n x slip; with spins (n, 5): and beside, moment about the slip
  Scalars speed;  ///< (n) U, m/s
};

/// Of pairs that close in. @param after what the collision made of them
[[nodiscard]] FrameRecords frame_records(const Pairs& pairs, const Motion& after, const ContactLaw& law,
                                         bool with_spins);

class FrameModel final : public CollisionModel {
 public:
  /// @param regressor of 2 inputs and 3 outputs, or of 5 and 5
  /// @param greatest_speed dimensionless, as in the records; faster pairs count as this fast
  FrameModel(const ContactLaw& law, std::shared_ptr<const Regressor> regressor, double greatest_speed);

  [[nodiscard]] SurrogateKind kind() const override { return SurrogateKind::frame; }
  [[nodiscard]] std::string text() const override { return "frame, " + regressor_->kind(); }
  void impulses(const Pairs& pairs, Impulses& impulses) const override;
  void write(io::TensorFile& file) const override;
  [[nodiscard]] static std::unique_ptr<FrameModel> read(const io::TensorFile& file, const ContactLaw& law);
  [[nodiscard]] const Regressor& regressor() const { return *regressor_; }

 private:
  ContactLaw law_;
  std::shared_ptr<const Regressor> regressor_;
  double greatest_speed_;
};

}  // namespace elrom::particle
