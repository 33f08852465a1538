#pragma once
// The kinds of movers, one a source. Internal.

#include "elrom/scene/mover.hpp"

namespace elrom::scene {

[[nodiscard]] std::unique_ptr<Mover> make_soft_spheres(const Domain& domain, const MoverSettings& settings);
[[nodiscard]] std::unique_ptr<Mover> make_stressed_parcels(const Domain& domain,
                                                           const MoverSettings& settings);
[[nodiscard]] std::unique_ptr<Mover> make_swept(const Domain& domain, const MoverSettings& settings);
[[nodiscard]] std::unique_ptr<Mover> make_proximity(const Domain& domain, const MoverSettings& settings);

}  // namespace elrom::scene
