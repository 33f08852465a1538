#include "elrom/base/error.hpp"
#include "elrom/ingest/store_summary.hpp"
#include "elrom/io/hdf5.hpp"
#include "value_range.hpp"

namespace elrom::ingest {

namespace {

using Json = nlohmann::ordered_json;

Json number_of(const io::Hdf5Object& object, const std::string& name) {
  return object.has_attribute(name) ? Json(object.numbers(name).at(0)) : Json(nullptr);
}

Json inputs_of(const io::Hdf5Group& elrom) {
  const auto dataset = elrom.dataset("boundary_conditions");
  const auto values = dataset.read<double>();
  const auto names = dataset.texts("names"), units = dataset.texts("units");
  if (names.size() != values.size() || units.size() != values.size()) {
    throw InputError({.what = "names and units do not fit the values", .where = dataset.where()});
  }
  Json inputs = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i)
    inputs.push_back({{"name", names[i]}, {"unit", units[i]}, {"value", values[i]}});
  return inputs;
}

Json fields_of(const io::Hdf5Group& fields) {
  Json result = Json::array();
  for (const auto& name : fields.names()) {
    const auto dataset = fields.dataset(name);
    Range range;
    for (const float value : dataset.read<float>()) range.add(static_cast<double>(value));
    Json entry{{"name", name}, {"unit", dataset.text("unit")}};
    entry.update(range.json());
    result.push_back(std::move(entry));
  }
  return result;
}

Json read_prediction(const std::filesystem::path& path) {
  const auto file = io::Hdf5File::open(path);
  io::check_kind(file, io::kinds::prediction);
  const auto elrom = file.group("elrom");
  Json result{{"kind", "prediction"}, {"case", elrom.text("case")}, {"load", number_of(elrom, "load")}};
  for (const char* const key :
       {"validity", "validity_reason", "method", "builds", "bundle_program", "bundle_digest"})
    result[key] = elrom.text(key);
  result["nearest"] =
      elrom.has_attribute("nearest_cases") ? elrom.texts("nearest_cases") : std::vector<std::string>{};
  result["interval_level"] = number_of(elrom, "interval_level");
  result["n_planes"] = elrom.dataset("mesh/planes").read<std::int32_t>().size();
  result["inputs"] = inputs_of(elrom);
  result["profiles"] = !elrom.has("fields");
  result["fields"] = fields_of(elrom.group(elrom.has("fields") ? "fields" : "profiles"));
  return result;
}

}  // namespace

Json describe_prediction(const std::filesystem::path& path) {
  io::survive(path, "prediction", [&] { static_cast<void>(read_prediction(path)); });
  return read_prediction(path);
}

}  // namespace elrom::ingest
