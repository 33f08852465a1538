#pragma once
// One row of the table of what elrom-serve answers. The router, the OpenAPI document and the tests that are
// made from it all go by the same rows.
//
// Thread rule: constants after start.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "elrom/http/message.hpp"
#include "elrom/repository/records.hpp"

namespace elrom::serve {

struct Desk;

struct Caller {
  std::string name;  ///< of the token; "anonymous"
  repository::Role role = repository::Role::reader;
};

/// A request that found its route and may be answered.
struct Ask {
  const http::Request& request;
  const http::Target& target;
  std::vector<std::string> parameters;  ///< what stands for {...} in the path
  Caller caller;
};

enum class BodyKind { none, json, hdf };

struct Parameter {
  std::string name, meaning;
};

struct Documented {
  int status;
  std::string meaning;
};

struct Route {
  std::string method, path;              ///< "GET", "/scenarios/{id}"
  std::optional<repository::Role> role;  ///< needed; nothing: anybody may
  std::string summary;
  std::vector<Documented> answers;  ///< besides those that follow from what is asked for (see all_answers)
  std::function<http::Response(Desk&, const Ask&)> answer;
  std::vector<Parameter> query = {};
  BodyKind body = BodyKind::none;
  std::string example = {};                               ///< JSON: a body that is right
  std::string wrong = {};                                 ///< JSON: one that is understood and refused
  std::vector<std::string> required = {};                 ///< keys of the body
  std::vector<std::string> media = {"application/json"};  ///< of the answer
  bool keyed = false;                                     ///< asks for an Idempotency-Key
  bool locked = false;                                    ///< asks for an If-Match
  bool tagged = false;                                    ///< the answer has an ETag, and is not sent twice
};

/// Every status that the route may answer with, but for those of any route (see the document's "default").
[[nodiscard]] std::vector<Documented> all_answers(const Route& route);

/// What stands in the path for {...}, in order; nothing: another path.
[[nodiscard]] std::optional<std::vector<std::string>> parameters_of(const Route& route,
                                                                    const std::vector<std::string>& segments);

/// The table.
[[nodiscard]] const std::vector<Route>& routes();
/// The table as an OpenAPI 3.1 document.
[[nodiscard]] const std::string& openapi_document();

}  // namespace elrom::serve
