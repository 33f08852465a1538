#pragma once
// A scene that runs: the list of effects made from its settings, the state that they change, steps,
// checkpoints.
//
// Thread rule: one thread calls; steps use threads of their own, and give the same bits for any number.

#include <memory>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/scene/scene_settings.hpp"

namespace elrom::scene {

/// An effect of the list with what it costs.
struct EffectCost {
  std::string name;
  double bytes_estimated = 0, seconds_estimated = 0;  ///< of the whole run
  double bytes = 0, seconds = 0;                      ///< measured so far
};

class Simulation {
 public:
  /// Reads what the effects need, places the spheres that are there at the start.
  /// @throws UsageError, InputError for what cannot be: no room for the spheres, an unknown region,
  /// friction with ...
  Simulation(SceneSettings settings, int n_threads, const MakeMover& make = make_mover);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  [[nodiscard]] const SceneSettings& settings() const { return settings_; }
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const Domain& domain() const { return domain_; }
  [[nodiscard]] const std::vector<std::string>& group_names() const { return group_names_; }
  [[nodiscard]] bool done() const { return state_.step >= settings_.n_steps(); }
  /// The gas of gas.model = "coupled"; else null.
  [[nodiscard]] const GasFlow* flow() const { return flow_.get(); }
  /// Spheres that are still to come.
  [[nodiscard]] std::int64_t due() const;

  /// One time step. @throws NumericalError where something is no number any more
  void step();
  /// Before state() is looked at as a whole: spheres that other processes have come back for it.
  void gather() { mover_->gather(state_); }
  /// Estimates are by the number of spheres; those of effects that work on cells too only after try_cells().
  [[nodiscard]] std::vector<EffectCost> costs() const;
  /// Runs the first ten steps of a copy of this scene, where an effect works on cells, and keeps their cost
  /// for the estimates: how often a gas iterates is not known beforehand.
  void try_cells();
  /// Of the movement, for people.
  [[nodiscard]] std::string text() const { return mover_->text(); }

  /// All of the state. The run that is saved goes on as one that was loaded does.
  [[nodiscard]] io::TensorFile save();
  /// @throws InputError for another scene's file, or a damaged one
  void load(const io::TensorFile& file);

 private:
  struct Timed {
    std::unique_ptr<Effect> effect;
    double seconds = 0;
    double cell_seconds = 0;  // of a call, estimated: what the spheres do not account for
  };
  void add(std::unique_ptr<Effect> effect);
  void add_forces();
  void add_gas(DragLaw law);
  void add_openings();
  void place_groups();
  void push(double dt);
  void apply(Timed& timed, double dt);
  void kick(double dt);
  [[nodiscard]] double calls_a_step(const Effect& effect) const;
  [[nodiscard]] Body region(const std::string& name) const;

  SceneSettings settings_;
  int n_threads_;
  Domain domain_;
  std::vector<std::string> group_names_;
  std::vector<Source> sources_;
  std::vector<std::int64_t> placed_;  // of each source; effects hold on to them
  std::shared_ptr<CellGrid> grid_;    // only where an effect asks for it
  std::unique_ptr<GasField> gas_;
  std::unique_ptr<GasFlow> flow_;
  std::unique_ptr<Mover> mover_;
  std::vector<Timed> effects_;
  State state_;
  bool has_forces_ = false;
};

/// SHA-256 of what decides a scene's result: all settings but the duration.
[[nodiscard]] std::string digest_of(const SceneSettings& settings);

}  // namespace elrom::scene
