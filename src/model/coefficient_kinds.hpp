#pragma once
// The registry of coefficient models, internal to model: what load_coefficient_model can read.

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "elrom/model/coefficient_model.hpp"

namespace elrom::model {

struct CoefficientKind {
  std::string_view name;  ///< CoefficientModel::kind() of what `load` gives
  std::unique_ptr<CoefficientModel> (*load)(const io::TensorFile& file, const std::string& prefix);
};

[[nodiscard]] std::span<const CoefficientKind> coefficient_kinds();

}  // namespace elrom::model
