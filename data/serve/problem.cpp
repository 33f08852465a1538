#include "problem.hpp"

#include <filesystem>
#include <new>
#include <nlohmann/json.hpp>

#include "elrom/repository/transaction.hpp"

namespace elrom::serve {
namespace {

int status_of(const Error& error) {
  if (dynamic_cast<const repository::NotFoundError*>(&error) != nullptr) return 404;
  if (dynamic_cast<const repository::ConflictError*>(&error) != nullptr) return 409;
  if (dynamic_cast<const repository::StaleError*>(&error) != nullptr) return 412;
  switch (error.status()) {
    case ExitStatus::usage:
    case ExitStatus::validity:
      return 400;
    case ExitStatus::input:
    case ExitStatus::numerical:
      return 422;
    case ExitStatus::not_built:
      return 501;
    case ExitStatus::internal:
      return 503;  // the machine: a full disk, a database that is away
    default:
      return 500;
  }
}

}  // namespace

http::Response problem_response(int status, const Problem& problem) {
  nlohmann::ordered_json document{{"type", "about:blank"},
                                  {"title", http::reason_of(status)},
                                  {"status", status},
                                  {"detail", problem.message()}};
  const auto add = [&](const char* key, const std::string& text) {
    if (!text.empty()) document[key] = text;
  };
  add("what", problem.what);
  add("where", problem.where);
  add("found", problem.found);
  add("expected", problem.expected);
  add("advice", problem.advice);
  // What was found may be anything, also no UTF-8.
  using Handler = nlohmann::ordered_json::error_handler_t;
  return {.status = status,
          .headers = {{"Content-Type", "application/problem+json"}},
          .body = document.dump(-1, ' ', false, Handler::replace) + "\n"};
}

http::Response problem_response(const std::exception& error) {
  if (const auto* ours = dynamic_cast<const Error*>(&error))
    return problem_response(status_of(*ours), ours->problem());
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr)
    return problem_response(503, {.what = "out of memory", .advice = "try again later"});
  if (const auto* files = dynamic_cast<const std::filesystem::filesystem_error*>(&error))
    return problem_response(503,
                            {.what = "the server's disk cannot be used", .found = files->code().message()});
  return problem_response(500, {.what = "the server made a mistake", .advice = "its log says more"});
}

}  // namespace elrom::serve
