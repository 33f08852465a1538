#include "elrom/serve/service.hpp"

#include <fmt/chrono.h>

#include <algorithm>
#include <chrono>

#include "desk.hpp"
#include "elrom/base/text.hpp"
#include "problem.hpp"
#include "static_files.hpp"

namespace elrom::serve {
namespace {

using repository::Role;

/// A route that a request's path is of, whatever its method.
struct Match {
  const Route* route = nullptr;
  std::vector<std::string> parameters;
  std::vector<std::string> methods;  ///< that the path allows
};

Match match(const http::Target& target, const std::string& method) {
  Match found;
  for (const auto& route : routes()) {
    auto parameters = parameters_of(route, target.segments);
    if (!parameters) continue;
    found.methods.push_back(route.method);
    if (route.method != method) continue;
    found.route = &route;
    found.parameters = std::move(*parameters);
  }
  return found;
}

std::string route_name(const http::Request& request) {
  const auto target = http::parse_target(request.target);
  const auto found = target ? match(*target, request.method) : Match{};
  return found.route == nullptr ? "other" : found.route->method + " " + found.route->path;
}

std::optional<std::string> bearer(const http::Request& request) {
  const auto* header = request.header("Authorization");
  const std::string scheme = "Bearer ";
  if (header == nullptr || !header->starts_with(scheme)) return std::nullopt;
  return base::trim(header->substr(scheme.size()));
}

http::Response unauthorised(const std::string& what) {
  auto response = problem_response(401, {.what = what, .expected = "Authorization: Bearer TOKEN"});
  response.headers.emplace_back("WWW-Authenticate", "Bearer");
  return response;
}

std::string media_of(const http::Request& request) {
  const auto* type = request.header("Content-Type");
  return type == nullptr ? "" : base::trim(type->substr(0, type->find(';')));
}

/// The JSON library looks at every byte of what it writes.
bool is_utf8(const std::string& text) {
  try {
    (void)Json(text).dump();
    return true;
  } catch (const Json::type_error&) {
    return false;
  }
}

/// A database takes nothing else for text.
bool is_text(const http::Target& target) {
  return std::ranges::all_of(target.segments, is_utf8) &&
         std::ranges::all_of(target.query,
                             [](const auto& pair) { return is_utf8(pair.first) && is_utf8(pair.second); });
}

bool is_key(const std::string* key) {
  constexpr std::size_t longest = 200;
  const auto is_visible = [](char c) { return c > ' ' && c < 0x7F; };
  return key != nullptr && !key->empty() && key->size() <= longest && std::ranges::all_of(*key, is_visible);
}

/// What a route asks for besides the right to it; nothing: it is all there.
std::optional<http::Response> lacks(const Route& route, const http::Request& request) {
  const std::string wanted = route.body == BodyKind::hdf ? "application/x-hdf5" : "application/json";
  if (route.body != BodyKind::none && media_of(request) != wanted)
    return problem_response(
        415, {.what = "body of another type", .found = "'" + media_of(request) + "'", .expected = wanted});
  if (route.keyed && !is_key(request.header("Idempotency-Key")))
    return problem_response(
        428, {.what = "no Idempotency-Key",
              .expected = "a text of your own, new for each write: at most 200 visible ASCII characters"});
  if (route.locked && request.header("If-Match") == nullptr)
    return problem_response(428, {.what = "no If-Match", .expected = "the ETag that you read"});
  return std::nullopt;
}

std::string time_text() {
  const auto now = std::chrono::system_clock::now();
  const auto ms =
      std::chrono::duration_cast<std::chrono::milliseconds>(now.time_since_epoch()).count() % 1000;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(now), ms);
}

}  // namespace

struct Service::Impl {
  Desk desk;
  explicit Impl(ServiceOptions options) : desk(std::move(options)) {}

  [[nodiscard]] std::optional<Caller> caller(const std::string& secret) {
    std::optional<repository::Token> token;
    desk.repository.read([&](repository::Transaction& transaction) { token = transaction.token_of(secret); });
    if (!token) return std::nullopt;
    return Caller{token->name, token->role};
  }

  /// @param who set where the caller may
  std::optional<http::Response> keep_out(const Route& route, const http::Request& request, Caller& who) {
    if (!route.role) return std::nullopt;
    const auto secret = bearer(request);
    if (!secret && !desk.options.anonymous) return unauthorised("no token");
    const auto known = secret ? caller(*secret) : std::optional(Caller{"anonymous", *desk.options.anonymous});
    if (!known) return unauthorised("a token that is not known");
    who = *known;
    if (who.role >= *route.role) return std::nullopt;
    return problem_response(403, {.what = "the token's role does not allow it",
                                  .found = std::string(repository::roles.name(who.role)),
                                  .expected = std::string(repository::roles.name(*route.role))});
  }

  http::Response answer(const http::Request& request) {
    const auto target = http::parse_target(request.target);
    if (!target || !is_text(*target))
      return problem_response(400, {.what = "no path of ours", .found = request.target});
    auto found = match(*target, request.method);
    if (found.route == nullptr) return elsewhere(request, *target, found);
    Caller who;
    if (auto refused = keep_out(*found.route, request, who)) return std::move(*refused);
    if (auto refused = lacks(*found.route, request)) return std::move(*refused);
    return found.route->answer(desk, {request, *target, std::move(found.parameters), std::move(who)});
  }

  http::Response elsewhere(const http::Request& request, const http::Target& target, const Match& found) {
    if (!found.methods.empty()) {
      auto response = problem_response(
          405,
          {.what = "not done to this", .found = request.method, .expected = base::join(found.methods, ", ")});
      response.headers.emplace_back("Allow", base::join(found.methods, ", "));
      return response;
    }
    if (request.method == "GET")
      if (auto file = static_file(desk.options.page, target, request)) return std::move(*file);
    return problem_response(404, {.what = "there is no such place", .found = request.target});
  }
};

Service::Service(ServiceOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
Service::~Service() = default;

repository::Repository& Service::repository() { return impl_->desk.repository; }
ResidentModel& Service::model() { return impl_->desk.model; }

std::size_t Service::body_limit(const http::Request& head) const {
  const auto target = http::parse_target(head.target);
  const auto found = target ? match(*target, head.method) : Match{};
  if (found.route == nullptr || found.route->body == BodyKind::none) return 0;
  const auto& options = impl_->desk.options;
  const bool may_be_known = bearer(head) || options.anonymous;  // a stranger sends nothing large
  return found.route->body == BodyKind::hdf && may_be_known ? options.most_fields_bytes
                                                            : options.most_json_bytes;
}

http::Response Service::handle(const http::Request& request) {
  http::Response response;
  try {
    response = impl_->answer(request);
  } catch (const std::exception& error) {
    response = problem_response(error);
    if (response.status >= 500 && impl_->desk.options.log)
      impl_->desk.options.log(Json{{"at", time_text()}, {"error", error.what()}}.dump(
          -1, ' ', false, Json::error_handler_t::replace));
  }
  response.headers.emplace_back("X-Content-Type-Options", "nosniff");
  return response;
}

http::Response Service::refuse(int status, const Problem& problem) {
  return problem_response(status, problem);
}

void Service::done(const http::Exchange& exchange) {
  impl_->desk.metrics.count(route_name(exchange.request), exchange.status, exchange.seconds,
                            exchange.answer_bytes);
  if (!impl_->desk.options.log) return;
  const Json line{{"at", time_text()},
                  {"client", exchange.request.client},
                  {"method", exchange.request.method},
                  {"target", exchange.request.target},
                  {"status", exchange.status},
                  {"bytes", exchange.answer_bytes},
                  {"seconds", exchange.seconds}};
  impl_->desk.options.log(line.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace elrom::serve
