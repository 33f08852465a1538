#pragma once
// The checks at the door for a file of fields that comes by itself, with no other cases to compare it with:
// bounds, and what physics allows.
//
// Thread rule: HDF5 files by one thread at a time.

#include <filesystem>
#include <optional>

#include "elrom/field/furnace.hpp"
#include "elrom/field/mesh.hpp"

namespace elrom::ingest {

/// @param file of kind elrom-prediction, whose values are finite; a part of the furnace is not judged
/// @param mesh that it is on: with centres and volumes
/// @param furnace nothing: without what a furnace's openings tell
/// @throws InputError with the first finding
void judge_physics_of(const std::filesystem::path& file, const field::Mesh& mesh,
                      const std::optional<field::Furnace>& furnace);

}  // namespace elrom::ingest
