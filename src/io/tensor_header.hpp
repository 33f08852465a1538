#pragma once
// The JSON header of a tensor file, read strictly; internal to io.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/io/tensor_file.hpp"

namespace elrom::io {

inline constexpr std::string_view metadata_key = "__metadata__";
inline constexpr std::string_view digest_prefix = "sha256:";
inline constexpr std::string_view header_digest_key = "sha256:header";
inline constexpr std::size_t digest_length = 64;
inline constexpr std::uint64_t largest_header = std::uint64_t{4} << 20;
inline constexpr std::size_t most_tensors = 16'384;

/// Where a tensor lies behind the header.
struct TensorEntry {
  DType type = DType::f32;
  std::vector<std::size_t> shape;
  std::uint64_t begin = 0, end = 0;
};

struct TensorHeader {
  std::map<std::string, TensorEntry> tensors;
  std::map<std::string, std::string> metadata;  ///< texts and digests
};

/// Reads the header and checks it against the size of what follows it: known types, shapes whose product does
/// not overflow and fits the place, no duplicate name, no hole, no overlap, nothing left over.
/// @throws InputError naming `where`
[[nodiscard]] TensorHeader parse_header(std::string_view json, std::uint64_t data_size,
                                        const std::string& where);

/// The header's JSON text, padded with spaces so that the data behind it begins at a multiple of 64 bytes.
[[nodiscard]] std::string format_header(const TensorHeader& header);

/// SHA-256 of the header's text with the 64 digits of its own digest left out.
[[nodiscard]] std::string header_digest(std::string_view json);

}  // namespace elrom::io
