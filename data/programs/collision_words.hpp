#pragma once
// Sets of collisions and collision models as JSON and in words, for inspect and collisions of elrom-data.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/collision_set.hpp"

namespace elrom::programs {

/// Keys: kind "collisions" and those of data/FORMATS.md, kind "elrom-collision-summary".
[[nodiscard]] nlohmann::ordered_json describe_collisions(const particle::CollisionSet& set);
/// Keys: kind "collision model", surrogate, model (in words), protocol, law, provenance, accuracy.
[[nodiscard]] nlohmann::ordered_json describe_collision_model(const particle::CollisionBundle& bundle);
/// Of either.
[[nodiscard]] std::string collision_words(const nlohmann::ordered_json& description);

/// "4.9 % of the kinetic energy lost", "0.2 % ... gained"
[[nodiscard]] std::string energy_words(double lost);

}  // namespace elrom::programs
