#pragma once
// elrom-predict from its arguments to its files.

#include "elrom/fields/arguments.hpp"

namespace elrom::fields {

/// @return the exit status
[[nodiscard]] int run(const Arguments& arguments);

}  // namespace elrom::fields
