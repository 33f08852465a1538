#include <unistd.h>

#include "desk.hpp"
#include "elrom/base/version.hpp"

namespace elrom::serve {
namespace {

using repository::Role;
using repository::Transaction;

http::Response health(Desk& desk, const Ask& /*ask*/) {
  desk.repository.read([](Transaction& transaction) { (void)transaction.tokens(); });
  const auto model = desk.model.now();
  return json_response({{"status", "ok"},
                        {"program", program_version()},
                        {"model", model ? Json(model->bundle().digest()) : Json()}});
}

http::Response openapi(Desk& /*desk*/, const Ask& /*ask*/) {
  return {.headers = {{"Content-Type", "application/json"}}, .body = openapi_document()};
}

http::Response metrics(Desk& desk, const Ask& /*ask*/) {
  std::map<std::string, double> gauges;
  desk.repository.read([&](Transaction& transaction) {
    for (const auto& [name, n] : transaction.counts()) gauges[name] = static_cast<double>(n);
  });
  gauges["model_open"] = desk.model.now() ? 1 : 0;
  return {.headers = {{"Content-Type", "text/plain; version=0.0.4"}}, .body = desk.metrics.text(gauges)};
}

http::Response caller(Desk& /*desk*/, const Ask& ask) {
  return json_response({{"name", ask.caller.name}, {"role", repository::roles.name(ask.caller.role)}});
}

http::Response list_tokens(Desk& desk, const Ask& /*ask*/) {
  Json items;
  desk.repository.read([&](Transaction& transaction) {
    items = Json::array();
    for (const auto& token : transaction.tokens()) items.push_back(document_of(token));
  });
  return json_response({{"items", items}});
}

/// The secret is told here and kept nowhere, so this write has no Idempotency-Key: a name is given once.
http::Response make_token(Desk& desk, const Ask& ask) {
  const JsonBody body(ask.request.body, {"role"});
  const auto role = repository::roles.value(body.text("role"));
  std::string secret;
  desk.repository.write(
      [&](Transaction& transaction) { secret = transaction.make_token(ask.parameters[0], role); });
  return json_response({{"name", ask.parameters[0]}, {"role", body.text("role")}, {"token", secret}}, 201);
}

http::Response remove_token(Desk& desk, const Ask& ask) {
  desk.repository.write([&](Transaction& transaction) { transaction.remove_token(ask.parameters[0]); });
  return {.status = 204};
}

}  // namespace

std::vector<Route> server_routes() {
  return {{.method = "GET",
           .path = "/healthz",
           .role = {},
           .summary = "Whether the server and its database answer",
           .answers = {{200, "they do"}},
           .answer = health},
          {.method = "GET",
           .path = "/openapi.json",
           .role = {},
           .summary = "This document",
           .answers = {{200, "OpenAPI 3.1"}},
           .answer = openapi},
          {.method = "GET",
           .path = "/metrics",
           .role = Role::reader,
           .summary = "Counts and times, for Prometheus",
           .answers = {{200, "text format 0.0.4"}},
           .answer = metrics,
           .media = {"text/plain"}},
          {.method = "GET",
           .path = "/caller",
           .role = Role::reader,
           .summary = "Whose token it is, and what he may do",
           .answers = {{200, "name and role"}},
           .answer = caller},
          {.method = "GET",
           .path = "/tokens",
           .role = Role::admin,
           .summary = "Names and roles of the tokens",
           .answers = {{200, "all of them"}},
           .answer = list_tokens},
          {.method = "PUT",
           .path = "/tokens/{name}",
           .role = Role::admin,
           .summary = "Makes a token; its secret is in the answer and nowhere else",
           .answers = {{201, "made"}, {409, "the name is taken"}},
           .answer = make_token,
           .body = BodyKind::json,
           .example = R"({"role": "reader"})",
           .wrong = R"({"role": "king"})",
           .required = {"role"}},
          {.method = "DELETE",
           .path = "/tokens/{name}",
           .role = Role::admin,
           .summary = "Takes a token back",
           .answers = {{204, "gone"}, {404, "there is no such token"}},
           .answer = remove_token}};
}

}  // namespace elrom::serve
