#include "text_encoding.hpp"

#include <cstdint>
#include <string_view>

namespace elrom::io {
namespace {

constexpr std::string_view utf8_mark = "\xef\xbb\xbf", little_mark = "\xff\xfe", big_mark = "\xfe\xff";

unsigned byte_at(std::string_view bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }

void add(std::string& text, std::uint32_t letter) {
  const auto tail = [&](unsigned shift) { text += static_cast<char>(0x80 | (letter >> shift & 0x3f)); };
  if (letter < 0x80) {
    text += static_cast<char>(letter);
  } else if (letter < 0x800) {
    text += static_cast<char>(0xc0 | letter >> 6);
    tail(0);
  } else if (letter < 0x10000) {
    text += static_cast<char>(0xe0 | letter >> 12);
    tail(6);
    tail(0);
  } else {
    text += static_cast<char>(0xf0 | letter >> 18);
    tail(12);
    tail(6);
    tail(0);
  }
}

/// How many bytes a letter has by its first one; 0: none begins so.
std::size_t length_by(unsigned first) {
  return first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
}

bool is_utf8(std::string_view bytes) {
  for (std::size_t i = 0; i < bytes.size();) {
    const auto length = length_by(byte_at(bytes, i));
    if (length == 0 || i + length > bytes.size()) return false;
    for (std::size_t k = 1; k < length; ++k)
      if ((byte_at(bytes, i + k) & 0xc0) != 0x80) return false;
    i += length;
  }
  return true;
}

std::string from_latin_1(std::string_view bytes) {
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) add(text, byte_at(bytes, i));
  return text;
}

/// @param bytes behind the byte order mark
std::string from_utf16(std::string_view bytes, bool little) {
  constexpr std::uint32_t unreadable = 0xfffd;
  const auto unit = [&](std::size_t i) {
    return byte_at(bytes, i + (little ? 1 : 0)) << 8 | byte_at(bytes, i + (little ? 0 : 1));
  };
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto first = unit(i);
    if (first < 0xd800 || first > 0xdfff) {
      add(text, first);
      continue;
    }
    const auto second = first < 0xdc00 && i + 3 < bytes.size() ? unit(i + 2) : 0;
    const bool is_pair = second >= 0xdc00 && second <= 0xdfff;
    add(text, is_pair ? 0x10000 + ((first - 0xd800) << 10) + (second - 0xdc00) : unreadable);
    if (is_pair) i += 2;
  }
  return text;
}

}  // namespace

std::string in_utf8(std::string bytes) {
  const std::string_view all = bytes;
  if (all.starts_with(utf8_mark)) return bytes.substr(utf8_mark.size());
  if (all.starts_with(little_mark) || all.starts_with(big_mark))
    return from_utf16(all.substr(little_mark.size()), all.starts_with(little_mark));
  if (is_utf8(all) || all.find('\0') != std::string_view::npos) return bytes;
  return from_latin_1(all);
}

}  // namespace elrom::io
