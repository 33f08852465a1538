#include "elrom/io/text_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::io {
namespace {

/// zlib passes files that are not gzip through unchanged.
std::unique_ptr<gzFile_s, int (*)(gzFile)> open(const std::filesystem::path& path) {
  return {gzopen(path.c_str(), "rb"), gzclose};
}

}  // namespace

std::string begin_of_text_file(const std::filesystem::path& path, std::size_t most_bytes) {
  const auto file = open(path);
  std::string text(most_bytes, '\0');
  const int got = file ? gzread(file.get(), text.data(), static_cast<unsigned>(most_bytes)) : 0;
  text.resize(static_cast<std::size_t>(std::max(0, got)));
  return text;
}

std::string read_text_file(const std::filesystem::path& path, std::size_t most_bytes) {
  if (std::filesystem::is_directory(path)) {
    throw InputError(
        {.what = "cannot read text", .where = path.string(), .found = "a directory", .expected = "a file"});
  }
  const auto file = open(path);
  if (!file) throw InputError({.what = "cannot open file", .where = path.string()});
  std::vector<char> block(std::size_t{1} << 16);
  gzbuffer(file.get(), static_cast<unsigned>(block.size()));
  std::string text;
  std::error_code unknown;  // the size of a pipe
  const auto size = std::filesystem::file_size(path, unknown);
  if (!unknown) text.reserve(std::min<std::size_t>(size, most_bytes));
  for (;;) {
    const int got = gzread(file.get(), block.data(), static_cast<unsigned>(block.size()));
    int fault = Z_OK;
    const char* reason = gzerror(file.get(), &fault);
    if (got < 0 || (fault != Z_OK && fault != Z_STREAM_END)) {
      throw InputError({.what = "cannot read text",
                        .where = path.string(),
                        .found = std::string("a damaged or truncated gzip stream (") + reason + ")"});
    }
    text.append(block.data(), static_cast<std::size_t>(got));
    if (text.size() > most_bytes) {
      throw InputError({.what = "text is too large",
                        .where = path.string(),
                        .expected = "at most " + std::to_string(most_bytes >> 20) + " MiB unpacked"});
    }
    if (got == 0) break;
  }
  text.shrink_to_fit();
  return text;
}

}  // namespace elrom::io
