#include "route.hpp"

#include <algorithm>

#include "elrom/base/text.hpp"

namespace elrom::serve {

std::vector<Documented> all_answers(const Route& route) {
  auto all = route.answers;
  const auto add = [&](bool holds, int status, const char* meaning) {
    const auto same = [&](const Documented& one) { return one.status == status; };
    if (holds && std::ranges::none_of(all, same)) all.push_back({status, meaning});
  };
  const bool json = route.body == BodyKind::json;
  const bool body = route.body != BodyKind::none;
  add(json, 400, "no JSON");
  add(route.role.has_value(), 401, "no token, or one that is not known");
  add(route.role && *route.role != repository::Role::reader, 403, "the token's role does not allow it");
  const bool names_one =
      route.path.find("{id}") != std::string::npos || route.path.find("{digest}") != std::string::npos;
  add(names_one, 404, "there is no such thing");
  add(route.keyed, 409, "the key was used for another request");
  add(route.locked, 412, "it was changed since it was read");
  add(body, 413, "the body is too large");
  add(body, 415, "the body is of another type");
  add(json, 422, "understood, and wrong");
  add(route.keyed || route.locked, 428, "the request lacks its Idempotency-Key or If-Match");
  add(route.tagged, 304, "the caller has it already");
  std::ranges::sort(all, {}, &Documented::status);
  return all;
}

std::optional<std::vector<std::string>> parameters_of(const Route& route,
                                                      const std::vector<std::string>& segments) {
  const auto parts = base::split(std::string_view(route.path).substr(1), '/');
  std::vector<std::string> parameters;
  if (parts.size() != segments.size()) return std::nullopt;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].starts_with('{'))
      parameters.push_back(segments[i]);
    else if (parts[i] != segments[i])
      return std::nullopt;
  }
  return parameters;
}

}  // namespace elrom::serve
