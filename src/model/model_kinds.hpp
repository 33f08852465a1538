#pragma once
// The registry of field models, internal to model: what load_field_model can read.

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "elrom/model/field_model.hpp"

namespace elrom::model {

struct ModelKind {
  std::string_view name;  ///< FieldModel::kind() of what `load` gives
  std::unique_ptr<FieldModel> (*load)(const io::TensorFile& file, const std::string& prefix,
                                      const Wanted& wanted);
};

[[nodiscard]] std::span<const ModelKind> model_kinds();

}  // namespace elrom::model
