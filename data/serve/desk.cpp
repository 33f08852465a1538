#include "desk.hpp"

#include <charconv>

#include "elrom/base/digest.hpp"

namespace elrom::serve {
namespace {

using repository::Answer;

http::Response response_of(const Answer& answer) {
  http::Response response{.status = answer.status, .body = answer.body};
  if (!answer.body.empty())
    response.headers.emplace_back("Content-Type",
                                  answer.status >= 400 ? "application/problem+json" : "application/json");
  if (!answer.tag.empty()) response.headers.emplace_back("ETag", answer.tag);
  if (!answer.place.empty()) response.headers.emplace_back("Location", answer.place);
  if (answer.repeated) response.headers.emplace_back("Idempotent-Replayed", "true");
  return response;
}

/// All that is asked: the same key with anything else is a mistake.
std::string digest_of(const Ask& ask) {
  const auto* condition = ask.request.header("If-Match");
  return base::Sha256()
      .add(std::string_view(ask.caller.name))
      .add(std::string_view(ask.request.method))
      .add(std::string_view(ask.request.target))
      .add(std::string_view(condition == nullptr ? "" : *condition))
      .add(std::string_view(ask.request.body))
      .hex();
}

std::optional<std::int64_t> number_in(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

}  // namespace

std::shared_ptr<const OpenModel> open_model(Desk& desk) {
  auto model = desk.model.now();
  if (model) return model;
  throw repository::NotFoundError(Problem{.what = "no model yet",
                                          .where = desk.options.model.string(),
                                          .advice = "train one with elrom-train run"});
}

repository::JudgedInputs judge_case(const JsonBody& body, const OpenModel& model) {
  Json one{{"case", body.text_or("case", "case")}, {"inputs", body.at("inputs")}};
  if (body.has("load")) one["load"] = body.number("load");
  return repository::judge_inputs(one.dump(), "request", &model.schema(), &model.guard());
}

http::Response json_response(const Json& document, int status) {
  return {
      .status = status, .headers = {{"Content-Type", "application/json"}}, .body = document.dump() + "\n"};
}

http::Response tagged_response(const Ask& ask, const Json& document, const std::string& tag) {
  if (auto known = known_already(ask.request, tag)) return std::move(*known);
  auto response = json_response(document);
  response.headers.emplace_back("ETag", tag);
  return response;
}

std::optional<http::Response> known_already(const http::Request& request, const std::string& tag) {
  if (!http::has_tag(request, tag)) return std::nullopt;
  return http::Response{.status = 304, .headers = {{"ETag", tag}}};
}

http::Response once(Desk& desk, const Ask& ask, const std::function<Answer(repository::Transaction&)>& work) {
  const auto* key = ask.request.header("Idempotency-Key");  // the service made sure that it is there
  return response_of(desk.repository.once({.key = *key, .digest = digest_of(ask)}, work));
}

repository::Id id_of(const Ask& ask, std::size_t i) {
  if (const auto id = number_in(ask.parameters[i])) return *id;
  throw repository::NotFoundError(Problem{.what = "no number", .found = "'" + ask.parameters[i] + "'"});
}

std::int64_t number_in(const std::string& text, const std::string& name, std::int64_t most) {
  const auto value = number_in(text);
  if (value && *value <= most) return *value;
  throw UsageError(Problem{.what = "wrong " + name,
                           .where = "query",
                           .found = "'" + text + "'",
                           .expected = "0 to " + std::to_string(most)});
}

repository::ListPart part_of(const Ask& ask) {
  repository::ListPart part;
  const auto read = [&](const char* name, std::int64_t otherwise, std::int64_t most) {
    const auto text = ask.target.value(name);
    return text ? number_in(*text, name, most) : otherwise;
  };
  constexpr std::int64_t longest = 1000;
  part.after = read("after", 0, std::numeric_limits<std::int64_t>::max());
  part.n = static_cast<int>(read("limit", part.n, longest));
  return part;
}

Json list_document(Json items, const repository::ListPart& part) {
  const bool more = static_cast<int>(items.size()) == part.n && part.n > 0;
  Json next = more ? items.back()["id"] : Json();
  return {{"items", std::move(items)}, {"next", std::move(next)}};
}

Json document_of(const repository::Scenario& scenario) {
  return {{"id", scenario.id},
          {"revision", scenario.revision},
          {"name", scenario.name},
          {"boiler", scenario.boiler},
          {"note", scenario.note},
          {"load", scenario.load < 0 ? Json() : Json(scenario.load)},
          {"inputs", Json::parse(scenario.inputs)},
          {"inputs_digest", scenario.inputs_digest},
          {"verdict", text_or_null(scenario.verdict)},
          {"reason", text_or_null(scenario.reason)},
          {"by", scenario.by},
          {"at", scenario.at}};
}

Json document_of(const repository::Run& run) {
  return {{"id", run.id},
          {"revision", run.revision},
          {"scenario", run.scenario},
          {"inputs_digest", run.inputs_digest},
          {"model", run.model},
          {"state", repository::run_states.name(run.state)},
          {"worker", text_or_null(run.worker)},
          {"lease_until", run.lease_until},
          {"not_before", run.not_before},
          {"attempts", run.attempts},
          {"reason", text_or_null(run.reason)},
          {"sources", run.sources},
          {"by", run.by},
          {"at", run.at}};
}

Json document_of(const repository::ModelResult& result) {
  return {{"id", result.id},
          {"run", result.run},
          {"scenario", result.scenario},
          {"inputs_digest", result.inputs_digest},
          {"model", result.model},
          {"version", result.version},
          {"verdict", text_or_null(result.verdict)},
          {"reason", text_or_null(result.reason)},
          {"document", result.document.empty() ? Json() : Json::parse(result.document)},
          {"fields", text_or_null(result.fields)},
          {"followed_by", result.followed_by},
          {"at", result.at}};
}

Json document_of(const repository::Quarantined& one) {
  return {{"id", one.id}, {"kind", one.kind}, {"reason", one.reason}, {"document", one.document},
          {"by", one.by}, {"at", one.at}};
}

Json document_of(const repository::Token& token) {
  return {{"name", token.name}, {"role", repository::roles.name(token.role)}, {"at", token.at}};
}

}  // namespace elrom::serve
