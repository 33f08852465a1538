#include <map>

#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "json_body.hpp"
#include "route.hpp"

namespace elrom::serve {
namespace {

/// The types of an example are the types that are meant.
Json schema_of(const Json& example) {
  if (example.is_string()) return {{"type", "string"}};
  if (example.is_boolean()) return {{"type", "boolean"}};
  if (example.is_number_integer()) return {{"type", "integer"}};
  if (example.is_number()) return {{"type", "number"}};
  if (example.is_array())
    return {{"type", "array"}, {"items", example.empty() ? Json::object() : schema_of(example[0])}};
  Json properties = Json::object();
  for (const auto& [key, value] : example.items()) properties[key] = schema_of(value);
  return {{"type", "object"}, {"properties", properties}};
}

Json parameter(const char* where, const std::string& name, const std::string& meaning, bool required) {
  return {{"name", name},
          {"in", where},
          {"required", required},
          {"description", meaning},
          {"schema", {{"type", "string"}}}};
}

Json parameters_in(const Route& route) {
  Json all = Json::array();
  for (const auto& part : base::split(route.path, '/'))
    if (part.starts_with('{')) all.push_back(parameter("path", part.substr(1, part.size() - 2), "", true));
  for (const auto& one : route.query) all.push_back(parameter("query", one.name, one.meaning, false));
  if (route.keyed)
    all.push_back(
        parameter("header", "Idempotency-Key", "Your own, new for each write: it is done once.", true));
  if (route.locked) all.push_back(parameter("header", "If-Match", "The ETag that was read.", true));
  if (route.tagged) all.push_back(parameter("header", "If-None-Match", "The ETag of what you have.", false));
  return all;
}

Json body_of(const Route& route) {
  if (route.body == BodyKind::hdf)
    return {{"required", true},
            {"content", {{"application/x-hdf5", {{"schema", {{"type", "string"}, {"format", "binary"}}}}}}}};
  const auto example = Json::parse(route.example);
  auto schema = schema_of(example);
  schema["required"] = route.required;
  Json content{{"schema", schema}, {"example", example}};
  if (!route.wrong.empty()) content["x-wrong-example"] = Json::parse(route.wrong);
  return {{"required", true}, {"content", {{"application/json", content}}}};
}

Json answers_of(const Route& route) {
  const Json problem{{"application/problem+json", {{"schema", {{"$ref", "#/components/schemas/Problem"}}}}}};
  Json all = Json::object();
  for (const auto& [status, meaning] : all_answers(route)) {
    Json one{{"description", meaning}};
    if (status >= 400) one["content"] = problem;
    if (status == 200 || status == 201)
      for (const auto& media : route.media) one["content"][media] = Json::object();
    all[std::to_string(status)] = one;
  }
  all["default"] = {
      {"description", "too many requests, too slow, a request that is none, or a server in trouble"},
      {"content", problem}};
  return all;
}

Json operation_of(const Route& route) {
  Json operation{{"summary", route.summary}};
  operation["security"] = Json::array();
  if (route.role) {
    operation["security"].push_back({{"token", Json::array()}});
    operation["x-role"] = repository::roles.name(*route.role);
  }
  if (const auto parameters = parameters_in(route); !parameters.empty()) operation["parameters"] = parameters;
  if (route.body != BodyKind::none) operation["requestBody"] = body_of(route);
  operation["responses"] = answers_of(route);
  return operation;
}

Json problem_schema() {
  Json properties = Json::object();
  for (const char* key :
       {"type", "title", "detail", "what", "where", "found", "expected", "advice", "quarantine"})
    properties[key] = {{"type", "string"}};
  properties["status"] = {{"type", "integer"}};
  return {{"type", "object"},
          {"description", "RFC 9457; what, where, found, expected and advice are the parts of detail."},
          {"required", {"type", "title", "status", "detail", "what"}},
          {"properties", properties}};
}

Json document() {
  Json paths = Json::object();
  for (const auto& route : routes()) {
    std::string method = route.method;
    for (char& c : method) c = static_cast<char>(c + ('a' - 'A'));
    paths[route.path][method] = operation_of(route);
  }
  return {{"openapi", "3.1.0"},
          {"info",
           {{"title", "ELROM"},
            {"version", version()},
            {"description",
             "What the models of a boiler exchange, and a resident predictor of its furnace's fields."}}},
          {"paths", paths},
          {"components",
           {{"schemas", {{"Problem", problem_schema()}}},
            {"securitySchemes", {{"token", {{"type", "http"}, {"scheme", "bearer"}}}}}}}};
}

}  // namespace

const std::string& openapi_document() {
  static const std::string text = document().dump(2) + "\n";
  return text;
}

}  // namespace elrom::serve
