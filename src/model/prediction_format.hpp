#pragma once
// Kind and version of prediction files; internal to model.

#include "elrom/base/version.hpp"

namespace elrom::model {

inline constexpr const char* prediction_kind = "elrom-prediction";
inline constexpr FormatVersion prediction_format{1, 1};

}  // namespace elrom::model
