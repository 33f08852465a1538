#pragma once
// Shared by the hdf5_*.cpp files: the C library's types, and its failures as our errors.

#include <hdf5.h>

#include <string>
#include <string_view>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::io::detail {

/// Switches off the library's own error printing, which it keeps per thread.
void quiet();
/// What the library gives as the innermost cause of its last failure.
[[nodiscard]] std::string last_cause();
/// @throws InputError (reading) when `result` is negative
hid_t readable(hid_t result, std::string_view what, const std::string& where);
/// @throws SystemError (writing) when `result` is negative
hid_t writable(hid_t result, std::string_view what, const std::string& where);

template <class T>
[[nodiscard]] hid_t native_type();
// Told here, or a source that uses one before it is written makes another.
template <>
hid_t native_type<float>();
template <>
hid_t native_type<double>();
template <>
hid_t native_type<std::int32_t>();
template <>
hid_t native_type<std::int64_t>();
template <>
hid_t native_type<std::uint8_t>();

/// Memory type of strings as the file keeps them.
struct TextType {
  Hdf5Id type;
  bool variable = false;
  std::size_t size = 0;  ///< of a fixed-length string, bytes
};
[[nodiscard]] TextType text_type_of(hid_t file_type, const std::string& where);
[[nodiscard]] Hdf5Id make_text_type(std::size_t size, bool ascii);
[[nodiscard]] bool is_ascii(std::string_view text);
/// Fixed-length records of the longest of `values`, padded with zeros.
struct TextBlock {
  std::string bytes;
  Hdf5Id type;
};
[[nodiscard]] TextBlock pack_texts(std::span<const std::string> values);

/// Reads n strings by `read(memory_type, buffer)`, whichever kind they are.
template <class Read>
[[nodiscard]] std::vector<std::string> unpack_texts(const TextType& text, hid_t space, std::size_t n,
                                                    Read&& read) {
  std::vector<std::string> values(n);
  if (n == 0) return values;
  if (!text.variable) {
    std::string bytes(n * text.size, '\0');
    read(text.type.get(), bytes.data());
    for (std::size_t i = 0; i < n; ++i)
      values[i] = std::string(bytes.substr(i * text.size, text.size).c_str());
    return values;
  }
  std::vector<char*> pointers(n, nullptr);
  read(text.type.get(), pointers.data());
  for (std::size_t i = 0; i < n; ++i) values[i] = pointers[i] != nullptr ? pointers[i] : "";
  H5Dvlen_reclaim(text.type.get(), space, H5P_DEFAULT, pointers.data());
  return values;
}

}  // namespace elrom::io::detail
