#pragma once
// Spheres in a LAMMPS: those of this process, and copies of those of others that are near. Internal.

#include <memory>

#include "elrom/scene/shared_sweep.hpp"

namespace elrom::lammps {

class Decomposition final : public scene::Team {
 public:
  /// @param all spheres, the same at all processes, inside of their period @param domain lives longer
  Decomposition(const scene::Domain& domain, const scene::State& all);
  ~Decomposition() override;
  Decomposition(const Decomposition&) = delete;
  Decomposition& operator=(const Decomposition&) = delete;

  /// Spheres of this process, and ghosts behind them.
  [[nodiscard]] scene::State& state() { return state_; }
  [[nodiscard]] std::size_t n_own() const { return n_own_; }
  [[nodiscard]] const scene::Partners& partners() const { return partners_; }

  /// Spheres go to the processes in whose parts they are. Lists hold all pairs that are apart by less than
  /// the skin, m.
  void renew(double skin);
  /// LAMMPS gets what state() says of own spheres; the other way around.
  void keep();
  void restore();
  /// Own spheres fly straight for so long, s.
  void fly(double time);

  void forward(std::span<double> values, std::size_t width) override;
  [[nodiscard]] double least(double value) override;

 private:
  class Box;
  void list_partners();

  std::unique_ptr<Box> box_;
  scene::State state_;
  std::size_t n_own_ = 0;
  bool is_pushed_ = false;  // by forces
  scene::Partners partners_;
};

}  // namespace elrom::lammps
