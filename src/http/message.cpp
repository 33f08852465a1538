#include "elrom/http/message.hpp"

#include <algorithm>
#include <array>

#include "elrom/base/text.hpp"

namespace elrom::http {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char letter = lower(c);
  return letter >= 'a' && letter <= 'f' ? letter - 'a' + 10 : -1;
}

std::optional<std::string> decoded(std::string_view text, bool plus_is_blank) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '+' && plus_is_blank) c = ' ';
    if (c == '%') {
      if (i + 2 >= text.size()) return std::nullopt;
      const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
      if (high < 0 || low < 0) return std::nullopt;
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) return std::nullopt;
    out += c;
  }
  return out;
}

bool parse_path(std::string_view path, std::vector<std::string>& segments) {
  if (path.empty() || path.front() != '/') return false;
  path.remove_prefix(1);
  while (!path.empty()) {
    const auto end = std::min(path.find('/'), path.size());
    const auto segment = decoded(path.substr(0, end), false);
    if (!segment || segment->empty() || *segment == "." || *segment == "..") return false;
    if (segment->find_first_of("/\\") != std::string::npos) return false;
    segments.push_back(*segment);
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return true;
}

bool parse_query(std::string_view query, std::vector<std::pair<std::string, std::string>>& pairs) {
  while (!query.empty()) {
    const auto part = query.substr(0, query.find('&'));
    const auto equals = std::min(part.find('='), part.size());
    const auto key = decoded(part.substr(0, equals), true);
    const auto value = decoded(part.substr(std::min(equals + 1, part.size())), true);
    if (!key || !value) return false;
    if (!part.empty()) pairs.emplace_back(*key, *value);
    query.remove_prefix(std::min(part.size() + 1, query.size()));
  }
  return true;
}

struct Reason {
  int status;
  std::string_view text;
};
constexpr std::array reasons{Reason{200, "OK"},
                             Reason{201, "Created"},
                             Reason{204, "No Content"},
                             Reason{304, "Not Modified"},
                             Reason{400, "Bad Request"},
                             Reason{401, "Unauthorized"},
                             Reason{403, "Forbidden"},
                             Reason{404, "Not Found"},
                             Reason{405, "Method Not Allowed"},
                             Reason{406, "Not Acceptable"},
                             Reason{408, "Request Timeout"},
                             Reason{409, "Conflict"},
                             Reason{412, "Precondition Failed"},
                             Reason{413, "Content Too Large"},
                             Reason{415, "Unsupported Media Type"},
                             Reason{422, "Unprocessable Content"},
                             Reason{428, "Precondition Required"},
                             Reason{429, "Too Many Requests"},
                             Reason{431, "Request Header Fields Too Large"},
                             Reason{500, "Internal Server Error"},
                             Reason{501, "Not Implemented"},
                             Reason{503, "Service Unavailable"},
                             Reason{507, "Insufficient Storage"}};

}  // namespace

const std::string* find_header(const Headers& headers, std::string_view name) {
  const auto same = [&](const auto& header) {
    return std::ranges::equal(header.first, name, [](char a, char b) { return lower(a) == lower(b); });
  };
  const auto found = std::ranges::find_if(headers, same);
  return found == headers.end() ? nullptr : &found->second;
}

std::optional<std::string> Target::value(std::string_view key) const {
  for (const auto& [name, text] : query)
    if (name == key) return text;
  return std::nullopt;
}

std::optional<Target> parse_target(std::string_view target) {
  Target parsed;
  const auto mark = std::min(target.find('?'), target.size());
  const auto query = target.substr(std::min(mark + 1, target.size()));
  if (!parse_path(target.substr(0, mark), parsed.segments) || !parse_query(query, parsed.query))
    return std::nullopt;
  return parsed;
}

bool has_tag(const Request& request, std::string_view tag) {
  const auto* header = request.header("If-None-Match");
  if (header == nullptr) return false;
  return std::ranges::any_of(base::split(*header, ','), [&](const std::string& one) {
    const auto named = base::trim(one);
    return named == "*" || named == tag || (named.starts_with("W/") && named.substr(2) == tag);
  });
}

std::string_view reason_of(int status) {
  const auto* const found = std::ranges::find(reasons, status, &Reason::status);
  return found == reasons.end() ? std::string_view() : found->text;
}

}  // namespace elrom::http
