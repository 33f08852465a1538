#pragma once
// A scene in several processes (MPI) by LAMMPS as a library: LAMMPS cuts space into a part for each process,
// moves spheres and hands them on, keeps copies of those of neighbouring parts and lists of neighbours. What
// happens between spheres and at walls is the swept collision model's (elrom/scene/shared_sweep.hpp), so that
// a scene ends alike in any number of processes, but for rounding.
//
// Rank 0 runs the scene: it reads, writes and keeps checkpoints, and has all spheres whenever it does. The
// others serve. Forces act where a sphere is. A rank that fails or dies takes the job along; run again, it
// goes on from the last checkpoint.
//
// Thread rule: one thread a process.

#include <memory>

#include "elrom/scene/scene_settings.hpp"

namespace elrom::lammps {

/// All processes of the job, from its making to its end: one in a process. Ranks meet in both.
class Processes {
 public:
  Processes();
  /// At rank 0: sends the others home.
  ~Processes();
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  [[nodiscard]] int rank() const;
  [[nodiscard]] int size() const;

  /// Rank 0: what moves the scene's spheres, in all processes. One simulation, which these outlive.
  /// @throws UsageError for what such a scene cannot have: other collisions than helscm, a coupled gas or
  /// drag that asks for the voidage, outlets, inlets, parcels
  [[nodiscard]] scene::MakeMover movers(const scene::SceneSettings& settings);

  /// Other ranks: works for rank 0 until it needs no more. An exception ends the job.
  void serve();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::lammps
