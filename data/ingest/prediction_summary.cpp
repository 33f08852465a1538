#include <nlohmann/json.hpp>

#include "elrom/ingest/store_summary.hpp"
#include "elrom/model/prediction_file.hpp"
#include "value_range.hpp"

namespace elrom::ingest {

namespace {

using Json = nlohmann::ordered_json;

Json number_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json inputs_of(const model::StoredPrediction& stored) {
  Json inputs = Json::array();
  for (std::size_t i = 0; i < stored.inputs.size(); ++i) {
    inputs.push_back(
        {{"name", stored.input_names[i]}, {"unit", stored.input_units[i]}, {"value", stored.inputs[i]}});
  }
  return inputs;
}

Json fields_of(const model::StoredPrediction& stored) {
  Json result = Json::array();
  for (const auto& field : stored.fields) {
    ValueRange range;
    for (const float value : field.values) range.add(static_cast<double>(value));
    Json entry{{"name", field.name}, {"unit", field.unit}};
    entry.update(range.json());
    result.push_back(std::move(entry));
  }
  return result;
}

}  // namespace

Json describe_prediction(const std::filesystem::path& path) {
  const auto stored = model::read_prediction(path);
  return {{"kind", "prediction"},
          {"case", stored.case_name},
          {"load", number_of(stored.load)},
          {"validity", stored.validity},
          {"validity_reason", stored.validity_reason},
          {"method", stored.method},
          {"builds", stored.builds},
          {"bundle_program", stored.bundle_program},
          {"bundle_digest", stored.bundle_digest},
          {"nearest", stored.nearest_cases},
          {"interval_level", number_of(stored.interval_level)},
          {"n_planes", stored.planes.size()},
          {"inputs", inputs_of(stored)},
          {"profiles", stored.profiles},
          {"fields", fields_of(stored)}};
}

}  // namespace elrom::ingest
