#pragma once
// Swept collisions (helscm) of spheres that several processes share. Each process holds its own spheres and,
// behind them, copies of those of others that are near: ghosts. What happens is what happens in one process,
// event by event, to rounding.
//
// Processes work through a span of time in rounds. In a round each knows what would happen to each of its own
// spheres next, and all of them the earliest such event. An event happens when both partners' processes take
// it for the next one of their sphere, and when no third sphere, whatever becomes of it from that earliest
// event on, can reach either partner before. Both compute it from the same numbers. The earliest event of all
// always happens, so rounds end; events that are far apart happen in one round.
//
// Thread rule: one thread a process; all processes make the same calls.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "elrom/scene/mover.hpp"

namespace elrom::scene {

/// All processes of a run.
class Team {
 public:
  virtual ~Team() = default;
  /// Ghosts get what their owners have. @param values (spheres and ghosts, width), row-major
  virtual void forward(std::span<double> values, std::size_t width) = 0;
  /// The least value of all processes.
  [[nodiscard]] virtual double least(double value) = 0;
};

/// Which spheres are near which: of each sphere, ghosts too, its partners; of two ghosts nothing is known.
struct Partners {
  std::vector<std::size_t> begin;  ///< (n + 1)
  std::vector<std::int32_t> of;    ///< in any order; one may be there twice
  [[nodiscard]] std::span<const std::int32_t> row(std::size_t i) const {
    return {of.data() + begin[i], begin[i + 1] - begin[i]};
  }
};

/// A span of time, a part of a step of the scene.
struct Span {
  double begin = 0, time = 0;  ///< s, of the scene; its length
  double step = 0;             ///< s, of all of the step
  double fastest = 0;          ///< no sphere becomes faster in it, m/s
};

class SharedSweep {
 public:
  /// @param domain without outlets; lives longer. @param settings of helscm
  SharedSweep(const Domain& domain, const MoverSettings& settings);
  ~SharedSweep();

  /// All that happens in a span of time. Own spheres are left where a straight flight through all of it leads
  /// them to their places at its end. Tallies count what befalls own spheres: a pair where its sphere of the
  /// lower number is one.
  /// @param state own spheres, and behind them ghosts, whose numbers and sizes are there
  /// @param partners all that can come together in the span at speeds up to span.fastest
  /// @return false, at all processes, when a sphere became faster: nothing in state is of use then
  [[nodiscard]] bool sweep(State& state, std::size_t n_own, const Partners& partners, const Span& span,
                           Team& team);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::scene
