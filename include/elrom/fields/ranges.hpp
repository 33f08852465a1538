#pragma once
// "0:10,20,30:" and "x0:x1,y0:y1,z0:z1" as the command line writes them.

#include <string_view>

#include "elrom/field/planes.hpp"
#include "elrom/model/cells.hpp"

namespace elrom::fields {

/// "a:b" is a, ..., b - 1; a missing side reaches to the end. Whether the mesh has them is seen later.
/// @throws UsageError
[[nodiscard]] field::Planes parse_planes(std::string_view text);
/// @throws UsageError
[[nodiscard]] model::Box parse_box(std::string_view text);

}  // namespace elrom::fields
