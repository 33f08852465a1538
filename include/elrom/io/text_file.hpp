#pragma once
// Whole text files, plain or gzip (told by their first bytes, not by their name).

#include <cstddef>
#include <filesystem>
#include <string>

namespace elrom::io {

/// Text larger than this when unpacked is refused: a small gzip file may stand for terabytes.
inline constexpr std::size_t most_unpacked_bytes = std::size_t{4} << 30;

/// @throws InputError when it cannot be read, is a damaged gzip file, or unpacks to more than `most_bytes`
[[nodiscard]] std::string read_text_file(const std::filesystem::path& path,
                                         std::size_t most_bytes = most_unpacked_bytes);
/// The first bytes of it, as many as there are up to `most_bytes`; empty for what cannot be read.
[[nodiscard]] std::string begin_of_text_file(const std::filesystem::path& path, std::size_t most_bytes);

}  // namespace elrom::io
