#pragma once
// Arrays of VTK's XML files: numbers as text, or as bytes in base64 or raw, compressed by zlib or not.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace elrom::ingest {

/// How a file holds the bytes of its arrays.
struct VtkEncoding {
  std::size_t header_bytes = 4;  ///< of one number in front of an array
  bool compressed = false;
  std::string where;           ///< the file, for messages
  std::size_t file_bytes = 0;  ///< a hostile file may claim more than it can hold
};

/// VTK's names of types: "Float32", "Int64". @return bytes of a value; 0: not known
[[nodiscard]] std::size_t bytes_of_vtk_type(std::string_view type);

/// Numbers as text. @throws InputError unless there are `n` of them
[[nodiscard]] std::vector<double> vtk_numbers(std::string_view text, std::size_t n, const std::string& where);

/// Numbers as bytes: `data` begins with the array's header. @param base64 whether `data` is text
/// @throws InputError for a header, a size or compressed bytes that do not fit
[[nodiscard]] std::vector<double> vtk_numbers(std::string_view data, bool base64, std::string_view type,
                                              std::size_t n, const VtkEncoding& encoding);

}  // namespace elrom::ingest
