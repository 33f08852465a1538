#pragma once
// A scene's run as a piece of long work: outputs in a folder, checkpoints, progress, and going on after a
// crash.
//
//   DIR/checkpoint.elrom     the state; a run that was killed goes on from it and gives the same bytes
//   DIR/series.csv           a row an output: spheres, mass, energy, collisions ...
//   DIR/section_<name>.csv   sums over the cells of each section, by output
//   DIR/residence.csv        how long the spheres that left had stayed, by group; where there are outlets
//   DIR/particles.pvd        a movie for ParaView of DIR/particles_<step>.vtp
//   DIR/scene.toml           the resolved settings
//
// Thread rule: one thread; steps use threads of their own.

#include <stop_token>

#include "elrom/scene/simulation.hpp"

namespace elrom::scene {

struct SceneRun {
  double seconds = 0;             ///< of the steps done now
  std::int64_t steps = 0;         ///< done now
  std::int64_t resumed_from = 0;  ///< step; 0: from the beginning
  std::vector<std::string> files;
};

/// Runs to the end. @throws UsageError when another process works in the folder; InputError for a
/// checkpoint of another scene; NumericalError; Interrupted on `stop`: the next run goes on from the last
/// checkpoint
SceneRun run(Simulation& simulation, const std::filesystem::path& folder, Log& log,
             const std::stop_token& stop);

/// Spheres as ParaView opens them (VTK XML, raw): points with diameter, velocity, group and id. Appears
/// whole.
void write_vtp(const std::filesystem::path& path, const Particles& particles, const Domain& domain);

}  // namespace elrom::scene
