#include "cases_tree.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "case_entries.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/field/case_json.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/io/setting_value.hpp"

namespace elrom::field::detail {

void check_case_key(const std::string& key, const std::string& where) {
  const auto name = base::split_unit(key).name;
  if (name == "case" || name == "load" || name == "inputs") return;
  throw InputError({.what = "unknown key '" + key + "'",
                    .where = where,
                    .advice = base::name_advice(key, {"case", "load", "inputs"})});
}

CaseInputs resolve(const RawCase& raw, const InputSchema& schema) {
  check_case_name(raw.name, raw.where);
  std::vector<std::string> headings;
  for (const auto& [key, value] : raw.inputs) headings.push_back(key);
  const auto columns = match_columns(headings, schema, raw.where);
  CaseInputs one{.name = raw.name, .load = std::nan("")};
  if (raw.load)
    one.load = checked_load(raw.load->second, base::split_unit(raw.load->first).symbol, raw.where);
  for (std::size_t i = 0; i < schema.size(); ++i) {
    const auto& [key, value] = raw.inputs[columns.position[i]];
    if (!std::isfinite(value))
      throw InputError({.what = "'" + key + "' is no finite number", .where = raw.where});
    one.values.push_back(to_si(value, columns.symbol[i], schema[i], raw.where));
  }
  return one;
}

namespace {

using Json = nlohmann::json;

[[noreturn]] void fail(std::string what, const std::string& where, std::string expected = {}) {
  throw InputError({.what = std::move(what), .where = where, .expected = std::move(expected)});
}

std::string case_place(const std::string& file, const std::string& name, std::size_t i) {
  return file + ", case " + (name.empty() ? std::to_string(i + 1) : "'" + name.substr(0, 60) + "'");
}

// A repeated key would silently win over its twin, so it is looked for while parsing.
Json parse_json(const std::string& text, const std::string& where) {
  std::vector<std::set<std::string>> open;
  const Json::parser_callback_t watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    constexpr int deepest = 16;
    if (depth > deepest) fail("nested too deeply", where);
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second) {
      fail("key '" + parsed.get<std::string>() + "' appears twice", where);
    }
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::exception& error) {
    fail(std::string("not JSON (") + error.what() + ")", where);
  }
}

RawCase raw_case(const Json& node, const std::string& file, std::size_t i) {
  RawCase raw{.where = case_place(file, "", i)};
  if (!node.is_object()) fail("a case that is no object", raw.where, "{\"case\": ..., \"inputs\": {...}}");
  if (!node.contains("case") || !node["case"].is_string()) fail("missing text 'case'", raw.where);
  raw.name = node["case"].get<std::string>();
  raw.where = case_place(file, raw.name, i);
  for (const auto& [key, value] : node.items()) {
    check_case_key(key, raw.where);
    if (base::split_unit(key).name != "load" || value.is_null()) continue;
    if (!value.is_number()) fail("'" + key + "' is no number", raw.where);
    raw.load = {key, value.get<double>()};
  }
  if (!node.contains("inputs") || !node["inputs"].is_object()) fail("missing object 'inputs'", raw.where);
  for (const auto& [key, value] : node["inputs"].items()) {
    if (!value.is_number()) fail("'" + key + "' is no number", raw.where);
    raw.inputs.emplace_back(key, value.get<double>());
  }
  return raw;
}

RawCase raw_case(const io::SettingValue& node, const std::string& file, std::size_t i) {
  RawCase raw{.where = case_place(file, "", i)};
  const auto number = [&](const io::SettingValue& value) {
    const auto real = value.real();
    if (!real) fail("'" + value.name() + "' is no number", raw.where);
    return *real;
  };
  const auto* name = node.member("case");
  if (name == nullptr || name->text() == nullptr) fail("missing text 'case'", raw.where);
  raw.name = *name->text();
  raw.where = case_place(file, raw.name, i);
  for (const auto& value : *node.table()) {
    if (value.name() == "cases") fail("'case' and [[cases]] in one file", raw.where);
    check_case_key(value.name(), raw.where);
    if (base::split_unit(value.name()).name == "load") raw.load = {value.name(), number(value)};
  }
  const auto* inputs = node.member("inputs");
  if (inputs == nullptr || inputs->table() == nullptr) fail("missing table 'inputs'", raw.where);
  for (const auto& value : *inputs->table()) raw.inputs.emplace_back(value.name(), number(value));
  return raw;
}

}  // namespace

std::vector<CaseInputs> read_cases_json(const std::filesystem::path& path, const InputSchema& schema) {
  const auto file = path.string();
  const auto root = parse_json(io::read_small_text(path), file);
  const bool wrapped = root.is_object() && root.contains("cases");
  const Json& list = wrapped ? root["cases"] : root;
  std::vector<CaseInputs> cases;
  if (list.is_array()) {
    for (std::size_t i = 0; i < list.size(); ++i)
      cases.push_back(resolve(raw_case(list[i], file, i), schema));
  } else {
    cases.push_back(resolve(raw_case(list, file, 0), schema));
  }
  return cases;
}

std::vector<CaseInputs> read_cases_toml(const std::filesystem::path& path, const InputSchema& schema) {
  const auto file = path.string();
  const auto root = io::parse_settings(io::read_small_text(path), file, io::SettingsFault::input);
  const auto* listed = root.member("cases");
  if (listed == nullptr) return {resolve(raw_case(root, file, 0), schema)};
  const auto* list = listed->list();
  if (list == nullptr || root.table()->size() != 1)
    fail("'cases' is no list of tables alone in its file", file, "[[cases]]");
  std::vector<CaseInputs> cases;
  for (std::size_t i = 0; i < list->size(); ++i) {
    if ((*list)[i].table() == nullptr) fail("a case that is no table", case_place(file, "", i));
    cases.push_back(resolve(raw_case((*list)[i], file, i), schema));
  }
  return cases;
}

}  // namespace elrom::field::detail

namespace elrom::field {

CaseInputs parse_case(const std::string& json, const std::string& where, const InputSchema& schema) {
  return detail::resolve(detail::raw_case(detail::parse_json(json, where), where, 0), schema);
}

InputSchema declared_schema(const std::string& json, const std::string& where) {
  const auto raw = detail::raw_case(detail::parse_json(json, where), where, 0);
  std::vector<InputInfo> inputs;
  for (const auto& [key, value] : raw.inputs) {
    const auto [name, symbol] = base::split_unit(key);
    if (std::ranges::find(inputs, name, &InputInfo::name) != inputs.end())
      detail::fail("boundary condition '" + name + "' appears twice", raw.where);
    inputs.push_back(detail::input_info(name, symbol.empty() ? "1" : symbol, raw.where));
  }
  return InputSchema(std::move(inputs));
}

}  // namespace elrom::field
