#pragma once
// Hard spheres with friction in closed form (Walton 1993): normal impulse m12 (1 + e) v_n; tangential the
// smaller of mu times that (sliding) and 2/7 m12 (1 + b) c (sticking), against the slip c. Rests on
// restitution e, friction mu and sticking restitution b of the law alone; a soft contact differs by how far
// it turns while it lasts, and where it slides first and sticks later.

#include "elrom/particle/collision_model.hpp"

namespace elrom::particle {

class ExactModel final : public CollisionModel {
 public:
  /// @throws UsageError as ContactLaw::check
  explicit ExactModel(const ContactLaw& law);
  [[nodiscard]] SurrogateKind kind() const override { return SurrogateKind::exact; }
  [[nodiscard]] std::string text() const override { return "exact, hard spheres"; }
  void impulses(const Pairs& pairs, Impulses& impulses) const override;
  void write(io::TensorFile& file) const override;

 private:
  double restitution_, friction_, sticking_;
};

}  // namespace elrom::particle
