#include "elrom/model/field_model.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "model_kinds.hpp"
#include "model_parts.hpp"

namespace elrom::model {

std::unique_ptr<FieldModel> load_field_model(const io::TensorFile& file, const std::string& prefix,
                                             const Wanted& wanted) {
  const auto description = parse_json(file.text(prefix), false);
  if (!description.is_object() || !description.contains("kind") || !description["kind"].is_string()) {
    throw InputError({.what = "no description of a model",
                      .where = file.where() + ":" + prefix,
                      .expected = "a JSON object with a \"kind\""});
  }
  const auto kind = description["kind"].get<std::string>();
  std::vector<std::string> names;
  for (const auto& entry : model_kinds()) {
    if (entry.name == kind) return entry.load(file, prefix, wanted);
    names.emplace_back(entry.name);
  }
  throw InputError({.what = "unknown kind of model '" + kind + "'",
                    .where = file.where() + ":" + prefix,
                    .advice = base::name_advice(kind, names) + "; a newer ELROM may have written it"});
}

}  // namespace elrom::model
