#include "bundle_info.hpp"

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/units.hpp"
#include "model_parts.hpp"

namespace elrom::model {
namespace {

using Json = nlohmann::json;

constexpr std::size_t most_cells = std::numeric_limits<std::int32_t>::max();  // corners are 32-bit

constexpr base::EnumNames<field::Parity, 4> parities{"parity",
                                                     {{field::Parity::scalar, "scalar"},
                                                      {field::Parity::vector_x, "vector_x"},
                                                      {field::Parity::vector_y, "vector_y"},
                                                      {field::Parity::vector_z, "vector_z"}}};

Json bound_to_json(const std::optional<double>& bound) { return bound ? Json(*bound) : Json(); }
std::optional<double> bound_from_json(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<double>());
}

Json to_json(const field::FieldInfo& info) {
  return {{"name", info.name},
          {"meaning", info.meaning},
          {"unit", info.unit},
          {"parity", parities.name(info.parity)},
          {"lower", bound_to_json(info.lower)},
          {"upper", bound_to_json(info.upper)}};
}

field::FieldInfo field_from_json(const Json& json) {
  field::FieldInfo info;
  info.name = json.at("name").get<std::string>();
  info.meaning = json.at("meaning").get<std::string>();
  info.unit = json.at("unit").get<std::string>();
  info.parity = parities.find(json.at("parity").get<std::string>()).value_or(field::Parity::scalar);
  info.lower = bound_from_json(json.at("lower"));
  info.upper = bound_from_json(json.at("upper"));
  return info;
}

/// With what the unit is in SI where not every ELROM knows it.
Json to_json(const field::InputInfo& input) {
  Json json{{"name", input.name}, {"unit", input.unit}, {"display_unit", input.display_unit}};
  const auto& unit = base::unit(input.display_unit);
  if (!base::is_common_unit(unit.symbol)) json.update({{"factor", unit.factor}, {"offset", unit.offset}});
  return json;
}

field::InputInfo input_from_json(const Json& json) {
  field::InputInfo input{json.at("name").get<std::string>(), json.at("unit").get<std::string>(),
                         json.at("display_unit").get<std::string>()};
  if (json.contains("factor"))
    base::know_unit(
        {input.display_unit, input.unit, json.at("factor").get<double>(), json.at("offset").get<double>()});
  return input;
}

Json to_json(const UsualFigure& figure) {
  return {{"name", figure.name},
          {"mean", figure.mean},
          {"deviation", figure.deviation},
          {"n_cases", figure.n_cases}};
}

UsualFigure figure_from_json(const Json& json) {
  return {json.at("name").get<std::string>(), json.at("mean").get<double>(),
          json.at("deviation").get<double>(), whole_number<std::size_t>(json.at("n_cases"))};
}

}  // namespace

std::string to_json(const BundleDescription& description) {
  const auto& info = description.info;
  Json json{{"method", info.method},
            {"cases", info.cases},
            {"provenance", info.provenance},
            {"accuracy", info.accuracy_json}};
  if (!info.case_digests.empty()) json["case_digests"] = info.case_digests;
  if (!info.settings.empty()) json["settings"] = info.settings;
  for (const auto& figure : info.usual_audit) json["usual_audit"].push_back(to_json(figure));
  json["fields"] = Json::array();
  for (const auto& field : info.fields) json["fields"].push_back(to_json(field));
  json["inputs"] = Json::array();
  for (const auto& input : info.schema.inputs()) json["inputs"].push_back(to_json(input));
  json["mesh"] = {{"n_planes", description.n_planes},
                  {"n_columns", description.n_columns},
                  {"digest", description.mesh_digest}};
  return json.dump();
}

BundleDescription bundle_description(const std::string& text, const std::string& where) {
  try {
    const Json json = parse_json(text);
    BundleDescription description;
    auto& info = description.info;
    info.method = json.at("method").get<std::string>();
    info.cases = json.at("cases").get<std::vector<std::string>>();
    info.provenance = json.at("provenance").get<std::map<std::string, std::string>>();
    info.accuracy_json = json.at("accuracy").get<std::string>();
    info.case_digests = json.value("case_digests", std::vector<std::string>());
    info.settings = json.value("settings", std::string());
    if (json.contains("usual_audit"))
      for (const auto& figure : json.at("usual_audit")) info.usual_audit.push_back(figure_from_json(figure));
    if (!info.case_digests.empty() && info.case_digests.size() != info.cases.size()) {
      throw InputError({.what = "broken bundle description",
                        .where = where,
                        .found = std::to_string(info.case_digests.size()) + " case_digests",
                        .expected = "one for each of " + std::to_string(info.cases.size()) + " cases"});
    }
    for (const auto& field : json.at("fields")) info.fields.push_back(field_from_json(field));
    std::vector<field::InputInfo> inputs;
    for (const auto& input : json.at("inputs")) inputs.push_back(input_from_json(input));
    info.schema = field::InputSchema(std::move(inputs));
    const auto& mesh = json.at("mesh");
    description.n_planes = whole_number<std::size_t>(mesh.at("n_planes"));
    description.n_columns = whole_number<std::size_t>(mesh.at("n_columns"));
    description.mesh_digest = mesh.at("digest").get<std::string>();
    std::size_t n_cells = 0;
    if (__builtin_mul_overflow(description.n_planes, description.n_columns, &n_cells) || n_cells == 0 ||
        n_cells > most_cells) {
      throw InputError({.what = "impossible mesh",
                        .where = where,
                        .found = std::to_string(description.n_planes) + " planes of " +
                                 std::to_string(description.n_columns) + " columns"});
    }
    return description;
  } catch (const Json::exception& fault) {
    throw InputError({.what = "broken bundle description", .where = where, .found = fault.what()});
  }
}

}  // namespace elrom::model
