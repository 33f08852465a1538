#include "elrom/repository/rules.hpp"

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/case_json.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/possible_inputs.hpp"
#include "elrom/model/prediction_file.hpp"

namespace elrom::repository {
namespace {

std::string document_of(const field::InputSchema& schema, const std::vector<double>& values) {
  std::map<std::string, double> sorted;
  for (std::size_t i = 0; i < values.size(); ++i)
    sorted[schema[i].name + " [" + schema[i].unit + "]"] = values[i];
  return nlohmann::json(sorted).dump();
}

/// The bounds of a field, with a little room: a float's rounding is no fault.
void judge_field(const model::StoredPrediction::Field& one, const std::string& where) {
  constexpr double room = 1e-5;
  const auto info = field::field_info(one.name, one.unit);
  for (std::size_t i = 0; i < one.values.size(); ++i) {
    const double value = one.values[i];
    const auto width = room * std::abs(value);
    const bool too_low = info.lower && value < *info.lower - width;
    const bool too_high = info.upper && value > *info.upper + width;
    if (std::isfinite(value) && !too_low && !too_high) continue;
    throw InputError(
        Problem{.what = std::isfinite(value) ? "impossible value" : "value that is no finite number",
                .where = where + ", field " + one.name + ", value " + std::to_string(i),
                .found = base::number(value) + " " + one.unit,
                .expected = too_low    ? "at least " + base::number(*info.lower)
                            : too_high ? "at most " + base::number(*info.upper)
                                       : ""});
  }
}

}  // namespace

JudgedInputs judge_inputs(const std::string& one, const std::string& where, const field::InputSchema* schema,
                          const model::Guard* guard) {
  const auto declared = schema == nullptr ? field::declared_schema(one, where) : field::InputSchema();
  const auto& used = schema == nullptr ? declared : *schema;
  JudgedInputs judged{.inputs = field::parse_case(one, where, used)};
  field::check_possible(judged.inputs, used);
  judged.document = document_of(used, judged.inputs.values);
  if (guard != nullptr) judged.assessment = guard->assess(judged.inputs.values);
  return judged;
}

void judge_fields(const std::filesystem::path& file, const std::string& mesh_digest) {
  const auto stored = model::read_prediction(file);
  if (!mesh_digest.empty() && stored.mesh_digest != mesh_digest)
    throw InputError(Problem{.what = "fields on another mesh",
                             .where = file.filename().string(),
                             .found = stored.mesh_digest,
                             .expected = mesh_digest});
  if (stored.fields.empty()) throw InputError(Problem{.what = "no field", .where = file.filename().string()});
  for (const auto& one : stored.fields) judge_field(one, file.filename().string());
}

}  // namespace elrom::repository
