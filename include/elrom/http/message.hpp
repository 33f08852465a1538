#pragma once
// Requests and responses as a server and its clients see them, without the library that carries them.
//
// Thread rule: plain data.

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace elrom::http {

using Headers = std::vector<std::pair<std::string, std::string>>;
/// The first of that name, whatever its capitals; nullptr: none.
[[nodiscard]] const std::string* find_header(const Headers& headers, std::string_view name);

struct Request {
  std::string method;  ///< "GET"
  std::string target;  ///< as sent: "/runs?state=waiting"
  Headers headers = {};
  std::string body = {};
  std::string client = {};  ///< address of the peer; set by the server

  [[nodiscard]] const std::string* header(std::string_view name) const { return find_header(headers, name); }
};

struct Response {
  int status = 200;
  Headers headers = {};
  std::string body = {};

  [[nodiscard]] const std::string* header(std::string_view name) const { return find_header(headers, name); }
};

/// A request's target, taken apart.
struct Target {
  std::vector<std::string> segments;  ///< of the path, decoded: "/a%20b/c" is {"a b", "c"}; "/" has none
  std::vector<std::pair<std::string, std::string>> query;  ///< decoded, in order

  [[nodiscard]] std::optional<std::string> value(std::string_view key) const;  ///< the first of that name
};
/// Nothing for a target that is no absolute path, and for one that nobody writes in good faith: broken
/// escapes, control characters, "." or ".." or a slash inside a segment.
[[nodiscard]] std::optional<Target> parse_target(std::string_view target);

/// Whether the request's If-None-Match names the ETag: what is asked for is there already (RFC 9110, 13.1.2).
[[nodiscard]] bool has_tag(const Request& request, std::string_view tag);

/// "Not Found"; "" for a status that has no name.
[[nodiscard]] std::string_view reason_of(int status);

}  // namespace elrom::http
