#pragma once
// Training on several processes: rank 0 runs the study and gives out units (crews of a screening, trials,
// builds); the others train what they are given, one unit at a time on one thread. A unit carries its seed,
// so a study ends with the same bytes whoever trained what. Only rank 0 opens the study's files; a checkpoint
// is kept by the rank that trains, where it can reach the study's folder.
//
// A rank that fails answers with its error, which ends the run as it would at rank 0. A rank that dies takes
// the job along (the launcher says which); the study goes on from its last stage, trial or checkpoint.

#include <functional>
#include <memory>
#include <stop_token>

#include "elrom/networks/workers.hpp"

namespace elrom::mpi {

/// All processes of the job, from its making to its end: one in a process. Ranks meet in both.
class World {
 public:
  /// @throws SystemError when this MPI cannot be called from threads
  World();
  /// At rank 0: sends the others home.
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  [[nodiscard]] int rank() const;
  [[nodiscard]] int size() const;

  /// Rank 0: the way to the other ranks. The world must outlive it.
  [[nodiscard]] std::unique_ptr<networks::Workers> workers() const;

  /// Other ranks: trains what rank 0 asks for until it needs no more. An exception of a unit, or of
  /// `make_trainer` (called with the first training), is sent to rank 0; any other ends the job, for rank 0
  /// would wait for ever. @param stop ends the training in hand
  void serve(const std::function<std::shared_ptr<const networks::Trainer>()>& make_trainer,
             const std::stop_token& stop) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::mpi
