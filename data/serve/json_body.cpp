#include "json_body.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::serve {
namespace {

constexpr int deepest = 32;
constexpr std::size_t longest_key = 200;  // names and units are compared with all that are known

void expect_sound(const std::string& text) {
  if (text.find('\0') != std::string::npos) throw InputError("a text with a NUL in it");
}

/// A repeated key would silently win over its twin.
Json parse(const std::string& text) {
  std::vector<std::set<std::string>> open;
  const Json::parser_callback_t watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > deepest)
      throw UsageError(
          Problem{.what = "JSON nested too deeply", .expected = "at most " + std::to_string(deepest)});
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event == Json::parse_event_t::value && parsed.is_string())
      expect_sound(parsed.get_ref<std::string&>());
    if (event == Json::parse_event_t::key) {
      const auto& key = parsed.get_ref<std::string&>();
      expect_sound(key);
      if (key.size() > longest_key)
        throw InputError({.what = "a key is too long",
                          .found = "'" + key + "'",
                          .expected = "at most " + std::to_string(longest_key) + " bytes"});
      if (!open.back().insert(key).second)
        throw InputError(Problem{.what = "a key appears twice", .found = "'" + key + "'"});
    }
    return true;
  };
  try {
    return Json::parse(text, watch);
  } catch (const Json::exception& error) {
    throw UsageError(Problem{.what = "no JSON", .found = error.what()});
  }
}

}  // namespace

JsonBody::JsonBody(const std::string& text, const std::vector<std::string>& keys, std::string where)
    : JsonBody(parse(text), keys, std::move(where), 0) {}

JsonBody::JsonBody(Json root, const std::vector<std::string>& keys, std::string where, int)
    : root_(std::move(root)), where_(std::move(where)) {
  if (!root_.is_object())
    throw InputError(
        Problem{.what = "no object", .where = where_, .found = root_.type_name(), .expected = "{...}"});
  expect_keys(keys);
}

void JsonBody::expect_keys(const std::vector<std::string>& keys) const {
  for (const auto& [key, value] : root_.items())
    if (std::ranges::find(keys, key) == keys.end())
      throw InputError(Problem{
          .what = "unknown key '" + key + "'", .where = where_, .advice = base::name_advice(key, keys)});
}

void JsonBody::fail(const std::string& key, const std::string& expected) const {
  const bool there = root_.contains(key);
  throw InputError(Problem{.what = there ? "wrong type of '" + key + "'" : "missing '" + key + "'",
                           .where = where_,
                           .found = there ? root_[key].type_name() : "",
                           .expected = expected});
}

const Json& JsonBody::at(const std::string& key) const {
  if (!root_.contains(key)) fail(key, "a value");
  return root_[key];
}

std::string JsonBody::text(const std::string& key) const {
  constexpr std::size_t longest = 10000;
  if (!has(key) || !root_[key].is_string()) fail(key, "a text");
  auto text = root_[key].get<std::string>();
  if (text.size() > longest)
    throw InputError(Problem{.what = "'" + key + "' is too long",
                             .where = where_,
                             .found = std::to_string(text.size()) + " bytes",
                             .expected = "at most " + std::to_string(longest)});
  return text;
}
std::string JsonBody::text_or(const std::string& key, std::string otherwise) const {
  return has(key) ? text(key) : std::move(otherwise);
}

double JsonBody::number(const std::string& key) const {
  if (!has(key) || !root_[key].is_number()) fail(key, "a number");
  return root_[key].get<double>();
}
double JsonBody::number_or(const std::string& key, double otherwise) const {
  return has(key) ? number(key) : otherwise;
}

std::int64_t JsonBody::whole(const std::string& key) const {
  if (!has(key) || !root_[key].is_number_integer()) fail(key, "a whole number");
  return root_[key].get<std::int64_t>();
}

bool JsonBody::flag_or(const std::string& key, bool otherwise) const {
  if (!has(key)) return otherwise;
  if (!root_[key].is_boolean()) fail(key, "true or false");
  return root_[key].get<bool>();
}

std::vector<std::string> JsonBody::texts(const std::string& key) const {
  std::vector<std::string> all;
  if (!has(key)) return all;
  if (!root_[key].is_array()) fail(key, "a list of texts");
  for (const auto& one : root_[key]) {
    if (!one.is_string()) fail(key, "a list of texts");
    all.push_back(one.get<std::string>());
  }
  return all;
}

std::vector<std::int64_t> JsonBody::wholes(const std::string& key) const {
  std::vector<std::int64_t> all;
  if (!has(key)) return all;
  if (!root_[key].is_array()) fail(key, "a list of whole numbers");
  for (const auto& one : root_[key]) {
    if (!one.is_number_integer()) fail(key, "a list of whole numbers");
    all.push_back(one.get<std::int64_t>());
  }
  return all;
}

JsonBody JsonBody::object(const std::string& key, const std::vector<std::string>& keys) const {
  if (!has(key) || !root_[key].is_object()) fail(key, "an object");
  return {root_[key], keys, where_ + ", " + key, 0};
}

}  // namespace elrom::serve
