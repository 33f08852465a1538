#pragma once
// Errors as problem documents (RFC 9457): the parts that our errors keep apart stay apart.

#include <exception>
#include <string>

#include "elrom/base/error.hpp"
#include "elrom/http/message.hpp"

namespace elrom::serve {

/// {"type": "about:blank", "title": ..., "status": ..., "detail": ..., "what": ..., "where": ..., "found":
/// ..., "expected": ..., "advice": ...}, empty parts left out.
[[nodiscard]] http::Response problem_response(int status, const Problem& problem);
/// What a failure means to a caller: the status of its kind, and no word of what is ours alone.
[[nodiscard]] http::Response problem_response(const std::exception& error);

}  // namespace elrom::serve
