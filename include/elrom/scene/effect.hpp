#pragma once
// What a scene names: one list of effects, built once, applied in the order of their phases. What a scene
// does not name is not in the list: it is not computed, not allocated and not loaded.
//
// Forces add to state.push (m/s2), which exists only where there is one; movers take it through the step,
// or get it as a kick of half a step before and after their straight paths (Strang splitting, second order).
//
// Thread rule: one thread calls; apply() may use threads of its own, and gives the same bits for any number.

#include <memory>
#include <string>

#include "elrom/scene/gas.hpp"
#include "elrom/scene/gas_flow.hpp"
#include "elrom/scene/mover.hpp"

namespace elrom::scene {

enum class Phase { force, motion, exchange };

class Effect {
 public:
  Effect(std::string name, Phase phase, double bytes_a_sphere, double seconds_a_sphere)
      : name_(std::move(name)),
        phase_(phase),
        bytes_a_sphere_(bytes_a_sphere),
        seconds_a_sphere_(seconds_a_sphere) {}
  virtual ~Effect() = default;
  virtual void apply(State& state, double dt) = 0;
  /// Whether a step costs something by the cells of the grid too, which only trying tells.
  [[nodiscard]] virtual bool works_on_cells() const { return false; }
  /// Held now, beyond the spheres' own arrays.
  [[nodiscard]] virtual std::size_t bytes() const { return 0; }
  virtual void save(io::TensorFile&) const {}
  virtual void load(const io::TensorFile&) {}

  [[nodiscard]] const std::string& name() const { return name_; }  ///< "drag wen_yu"
  [[nodiscard]] Phase phase() const { return phase_; }
  /// Estimates: bytes of a sphere; processor seconds of a sphere and step, on a machine of 2020 or so.
  [[nodiscard]] double bytes_a_sphere() const { return bytes_a_sphere_; }
  [[nodiscard]] double seconds_a_sphere() const { return seconds_a_sphere_; }

 private:
  std::string name_;
  Phase phase_;
  double bytes_a_sphere_, seconds_a_sphere_;
};

[[nodiscard]] std::unique_ptr<Effect> gravity(const Vec& acceleration);
/// Weight of the gas that a sphere displaces. @param gas_density kg/m3
[[nodiscard]] std::unique_ptr<Effect> buoyancy(const Vec& gravity, double gas_density);

using particle::drag_names;
using particle::DragLaw;
/// After all other forces: with rate b = drag / mass and the others' acceleration a, the velocity moves
/// towards u + a/b as exp(-b t), which is exact for a constant rate and has the right rest state at any step.
/// @param field lives longer @param grid where laws that ask for it find the voidage; null for others
[[nodiscard]] std::unique_ptr<Effect> drag(DragLaw law, const particle::Gas& gas, const GasField& field,
                                           std::shared_ptr<const CellGrid> grid, int n_threads);
/// Drag, the pressure's gradient and the gas that answers them (gas_flow.hpp). The last of the forces.
/// What spheres get the gas loses, to rounding. @param flow lives longer
[[nodiscard]] std::unique_ptr<Effect> coupled_gas(DragLaw law, GasFlow& flow, int n_threads);

}  // namespace elrom::scene
