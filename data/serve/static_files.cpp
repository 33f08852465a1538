#include "static_files.hpp"

#include <array>

#include "elrom/base/atomic_file.hpp"

namespace elrom::serve {
namespace {

constexpr const char* policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; font-src 'self'; "
    "connect-src 'self'; worker-src 'self' blob:; manifest-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

struct Type {
  std::string_view ending, media;
};
constexpr std::array types{Type{".html", "text/html; charset=utf-8"},
                           Type{".js", "text/javascript; charset=utf-8"},
                           Type{".mjs", "text/javascript; charset=utf-8"},
                           Type{".css", "text/css; charset=utf-8"},
                           Type{".json", "application/json"},
                           Type{".svg", "image/svg+xml"},
                           Type{".png", "image/png"},
                           Type{".ico", "image/x-icon"},
                           Type{".woff2", "font/woff2"},
                           Type{".wasm", "application/wasm"},
                           Type{".txt", "text/plain; charset=utf-8"}};

std::string media_of(const std::filesystem::path& file) {
  for (const auto& type : types)
    if (file.extension() == type.ending) return std::string(type.media);
  return "application/octet-stream";
}

/// Links that lead out of the folder, too.
bool lies_in(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const auto inside = std::filesystem::relative(file, folder);
  return !inside.empty() && *inside.begin() != "..";
}

/// A file that was replaced has another time: nobody has to read it to know.
std::string tag_of(const std::filesystem::path& file) {
  const auto changed = std::filesystem::last_write_time(file).time_since_epoch().count();
  return "\"" + std::to_string(changed) + "-" + std::to_string(std::filesystem::file_size(file)) + "\"";
}

}  // namespace

std::optional<http::Response> static_file(const std::filesystem::path& folder, const http::Target& target,
                                          const http::Request& request) {
  if (folder.empty()) return std::nullopt;
  auto named = folder;
  for (const auto& segment : target.segments) {
    if (segment.starts_with('.')) return std::nullopt;
    named /= segment;
  }
  if (target.segments.empty()) named /= "index.html";
  std::error_code fault;
  const auto root = std::filesystem::canonical(folder, fault),
             file = std::filesystem::canonical(named, fault);
  if (fault || !std::filesystem::is_regular_file(file) || !lies_in(file, root)) return std::nullopt;
  http::Response response{.headers = {{"Content-Type", media_of(file)},
                                      {"Content-Security-Policy", policy},
                                      {"Referrer-Policy", "no-referrer"},
                                      {"Cross-Origin-Opener-Policy", "same-origin"},
                                      {"Cache-Control", "no-cache"},  // looked for anew each time
                                      {"ETag", tag_of(file)}}};
  if (http::has_tag(request, *response.header("ETag")))
    response.status = 304;
  else
    response.body = base::read_text(file);
  return response;
}

}  // namespace elrom::serve
