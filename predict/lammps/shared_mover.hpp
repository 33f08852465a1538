#pragma once
// A scene's spheres moved in all processes of a job. Internal.

#include <memory>

#include "elrom/scene/mover.hpp"
#include "job.hpp"

namespace elrom::lammps {

/// Each process's state holds the spheres of its part of space; all of them rank 0's before the first step,
/// and after gather(). Rank 0's calls order the others to make the same.
/// @param job, domain live longer
[[nodiscard]] std::unique_ptr<scene::Mover> make_shared_mover(Job& job, const scene::Domain& domain,
                                                              const scene::MoverSettings& settings);

}  // namespace elrom::lammps
