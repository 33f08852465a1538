#pragma once
// elrom-predict from its arguments to its files.

#include "arguments.hpp"

namespace elrom::predict {

/// @return the exit status
[[nodiscard]] int run(const Arguments& arguments);

}  // namespace elrom::predict
