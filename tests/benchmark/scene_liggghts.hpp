#pragma once
// Debian's LIGGGHTS beside our soft spheres: a peer of the discrete element method, on the same scene.

#include <cstdint>
#include <optional>

#include "elrom/scene/scene_settings.hpp"

namespace elrom::benchmark {

struct LiggghtsRun {
  std::int64_t steps = 0;
  double time_step = 0;  ///< s
  double seconds = 0;    ///< of the processor
  std::int64_t collisions = 0;
  double energy_ratio = 0;
};

/// The spheres of a scene without walls and forces, by a linear contact law without friction: the same
/// places, velocities, stiffness and damping, in as many steps as collisions = "dem" takes, on one core. Runs
/// it twice, for contacts are counted aside from what is timed. Null, and a line that says so, where there is
/// no program liggghts. @throws SystemError where it fails
[[nodiscard]] std::optional<LiggghtsRun> by_liggghts(const scene::SceneSettings& settings);

}  // namespace elrom::benchmark
