#include "tensor_header.hpp"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "dtype_names.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t most_dimensions = 8;

/// Reads exactly {"__metadata__": {name: text, ...}, name: {"dtype", "shape", "data_offsets"}, ...} and takes
/// everything else for a fault, told in words of what was found. Written for this grammar: a general JSON
/// parser spends a tenth of a prediction on a header.
class HeaderReader {
 public:
  explicit HeaderReader(std::string_view text) : text_(text) {}

  /// @throws Fault
  TensorHeader read() {
    bool had_metadata = false;
    for_every_member([&](std::string name) {
      if (name == metadata_key) {
        if (std::exchange(had_metadata, true)) throw Fault{"__metadata__ twice"};
        read_metadata(name);
      } else {
        read_entry(std::move(name));
      }
    });
    skip_space();
    if (at_ != text_.size()) no_json();
    return std::move(header_);
  }

  struct Fault {
    std::string found;
  };

 private:
  void read_metadata(const std::string& name) {
    if (next() != '{') other_than_expected(name, name);
    for_every_member([&](std::string key) {
      if (next() != '"') other_than_expected(name, key);
      // Names come in order from our own writer: the hint makes that case quick.
      const auto size = header_.metadata.size();
      const auto place = header_.metadata.emplace_hint(header_.metadata.end(), std::move(key), read_string());
      if (header_.metadata.size() == size) throw Fault{"metadata name '" + place->first + "' twice"};
    });
  }

  void read_entry(std::string name) {
    if (next() != '{') other_than_expected(name, name);
    TensorEntry entry;
    int seen = 0;  // bits: dtype 1, shape 2, data_offsets 4
    for_every_member([&](const std::string& key) {
      const int bit = key == "dtype" ? 1 : key == "shape" ? 2 : key == "data_offsets" ? 4 : 0;
      if (bit == 0 || next() != (bit == 1 ? '"' : '[')) other_than_expected(name, key);
      if ((seen & bit) != 0) throw Fault{"'" + key + "' of tensor '" + name + "' twice"};
      seen |= bit;
      if (bit == 1) {
        entry.type = read_type(name);
      } else if (bit == 2) {
        const auto numbers = read_numbers();
        entry.shape.assign(numbers.begin(), numbers.end());
      } else {
        const auto numbers = read_numbers();
        if (numbers.size() != 2) throw Fault{"data_offsets of tensor '" + name + "' without two numbers"};
        entry.begin = numbers[0];
        entry.end = numbers[1];
      }
    });
    if (seen != 7) throw Fault{"tensor '" + name + "' without dtype, shape or data_offsets"};
    if (header_.tensors.size() >= most_tensors)
      throw Fault{"more than " + std::to_string(most_tensors) + " tensors"};
    const auto size = header_.tensors.size();
    const auto place = header_.tensors.emplace_hint(header_.tensors.end(), std::move(name), std::move(entry));
    if (header_.tensors.size() == size) throw Fault{"tensor '" + place->first + "' twice"};
  }

  DType read_type(const std::string& name) {
    const auto text = read_string();
    const auto type = dtype_names.find(text);
    if (!type)
      throw Fault{"type '" + text + "' of tensor '" + name +
                  "' (known: " + base::join(dtype_names.names(), ", ") + ")"};
    return *type;
  }

  std::vector<std::uint64_t> read_numbers() {
    std::vector<std::uint64_t> numbers;
    ++at_;  // '['
    if (next() == ']') return ++at_, numbers;
    for (;;) {
      numbers.push_back(read_number());
      if (numbers.size() > most_dimensions) throw Fault{"more than 8 numbers in a list"};
      const char end = next();
      ++at_;
      if (end == ']') return numbers;
      if (end != ',') no_json(at_ - 1);
    }
  }

  std::uint64_t read_number() {
    if (next() == '-') throw Fault{"a negative number"};
    const char* begin = text_.data() + at_;
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    if (end == begin || (*begin == '0' && end - begin > 1)) no_json();
    at_ = static_cast<std::size_t>(end - text_.data());
    const bool goes_on = at_ < text_.size() && (text_[at_] == '.' || text_[at_] == 'e' || text_[at_] == 'E');
    if (error != std::errc() || goes_on) throw Fault{"a number that is no whole number"};
    return value;
  }

  /// From '{' to behind its '}'. @param member(name) reads the value, which next() stands before
  template <class Member>
  void for_every_member(const Member& member) {
    if (next() != '{') no_json();
    ++at_;
    if (next() == '}') {
      ++at_;
      return;
    }
    for (;;) {
      if (next() != '"') no_json();
      auto name = read_string();
      if (next() != ':') no_json();
      ++at_;
      member(std::move(name));
      const char end = next();
      ++at_;
      if (end == '}') return;
      if (end != ',') no_json(at_ - 1);
    }
  }

  std::string read_string() {
    std::string value;
    bool ascii = true;
    for (std::size_t begin = ++at_;; ++at_) {
      if (at_ >= text_.size()) no_json();
      const char c = text_[at_];
      ascii = ascii && static_cast<unsigned char>(c) < 0x80;
      if (static_cast<unsigned char>(c) < 0x20) no_json();
      if (c != '"' && c != '\\') continue;
      value.append(text_, begin, at_ - begin);
      if (c == '"') break;
      ++at_;
      append_escaped(value);
      begin = at_ + 1;
    }
    if (!ascii && !is_utf8(value)) no_json();
    ++at_;
    return value;
  }

  /// at_ stands at what follows a backslash, and is left at its last character.
  void append_escaped(std::string& value) {
    constexpr std::string_view letters = "\"\\/bfnrt", meanings = "\"\\/\b\f\n\r\t";
    if (at_ >= text_.size()) no_json();
    if (const auto place = letters.find(text_[at_]); place != std::string_view::npos) {
      value += meanings[place];
      return;
    }
    if (text_[at_] != 'u') no_json();
    std::uint32_t code = read_hexadecimal();
    if (code >= 0xd800 && code < 0xe000) {  // the first half of a pair, and what must follow
      if (code >= 0xdc00 || text_.substr(at_ + 1, 2) != "\\u") no_json();
      at_ += 2;
      const std::uint32_t low = read_hexadecimal();
      if (low < 0xdc00 || low >= 0xe000) no_json();
      code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
    }
    append_utf8(value, code);
  }

  std::uint32_t read_hexadecimal() {
    std::uint32_t code = 0;
    const auto digits = text_.substr(std::min(at_ + 1, text_.size()), 4);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
    if (digits.size() != 4 || error != std::errc() || end != digits.data() + 4) no_json();
    at_ += 4;
    return code;
  }

  static void append_utf8(std::string& value, std::uint32_t code) {
    const auto add = [&](std::uint32_t bits) { value += static_cast<char>(bits); };
    if (code < 0x80) return add(code);
    if (code < 0x800) {
      add(0xc0 | code >> 6);
    } else if (code < 0x10000) {
      add(0xe0 | code >> 12);
      add(0x80 | (code >> 6 & 0x3f));
    } else {
      add(0xf0 | code >> 18);
      add(0x80 | (code >> 12 & 0x3f));
      add(0x80 | (code >> 6 & 0x3f));
    }
    add(0x80 | (code & 0x3f));
  }

  /// Well-formed (Unicode, table 3-7): no overlong form, no half of a pair, nothing above U+10FFFF.
  static bool is_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
      const auto byte = [&](std::size_t k) -> unsigned {
        return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0U;
      };
      const unsigned first = byte(0);
      const std::size_t n = first < 0x80                     ? 1
                            : first >= 0xc2 && first <= 0xdf ? 2
                            : first >= 0xe0 && first <= 0xef ? 3
                            : first >= 0xf0 && first <= 0xf4 ? 4
                                                             : 0;
      if (n == 0) return false;
      const unsigned low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
      const unsigned high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
      for (std::size_t k = 1; k < n; ++k)
        if (byte(k) < (k == 1 ? low : 0x80) || byte(k) > (k == 1 ? high : 0xbf)) return false;
      i += n;
    }
    return true;
  }

  void skip_space() {
    while (at_ < text_.size() && std::string_view(" \t\n\r").find(text_[at_]) != std::string_view::npos)
      ++at_;
  }
  /// The next character that is no space. At the end of the text there is none, and so no JSON.
  char next() {
    skip_space();
    if (at_ >= text_.size()) no_json();
    return text_[at_];
  }

  [[noreturn]] void other_than_expected(const std::string& name, const std::string& key) {
    const char c = next();
    if (c == '{') throw Fault{"an object inside '" + name + "'"};
    if (c == '[') throw Fault{"a list at '" + key + "'"};
    if (c == '"') throw Fault{"a text at '" + key + "'"};
    if (c == '-') throw Fault{"a negative number"};
    if (c >= '0' && c <= '9') throw Fault{"a number outside shape and data_offsets"};
    for (const std::string_view word : {"true", "false", "null"})
      if (text_.substr(at_).starts_with(word)) throw Fault{std::string(word) + " at '" + key + "'"};
    no_json();
  }
  [[noreturn]] void no_json() const { no_json(at_); }
  [[noreturn]] static void no_json(std::size_t place) {
    throw Fault{"text that is no JSON at byte " + std::to_string(place)};
  }

  std::string_view text_;
  std::size_t at_ = 0;
  TensorHeader header_;
};

/// Bytes of a tensor, or nothing when the product overflows.
std::optional<std::uint64_t> checked_bytes(const TensorEntry& entry) {
  std::uint64_t bytes = size_of(entry.type);
  bool zero = false;
  for (const auto extent : entry.shape) zero = zero || extent == 0;
  if (zero) return 0;
  for (const auto extent : entry.shape) {
    if (__builtin_mul_overflow(bytes, static_cast<std::uint64_t>(extent), &bytes)) return std::nullopt;
  }
  return bytes;
}

/// The tensors must tile [0, data_size) without hole or overlap.
std::string layout_fault(const TensorHeader& header, std::uint64_t data_size) {
  std::vector<const std::pair<const std::string, TensorEntry>*> order;
  order.reserve(header.tensors.size());
  for (const auto& item : header.tensors) {
    const auto bytes = checked_bytes(item.second);
    if (!bytes || item.second.end < item.second.begin || item.second.end - item.second.begin != *bytes) {
      return "tensor '" + item.first + "' whose shape and place differ";
    }
    order.push_back(&item);
  }
  std::sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
    return std::pair(a->second.begin, a->second.end) < std::pair(b->second.begin, b->second.end);
  });
  std::uint64_t reached = 0;
  for (const auto* item : order) {
    if (item->second.begin != reached) return "a hole or an overlap before tensor '" + item->first + "'";
    reached = item->second.end;
  }
  if (reached == data_size) return {};
  return std::to_string(data_size) + " bytes of data where the header describes " + std::to_string(reached);
}

}  // namespace

TensorHeader parse_header(std::string_view json, std::uint64_t data_size, const std::string& where) {
  std::string found = "no JSON object";
  if (!json.empty() && json.front() == '{') {
    try {
      auto header = HeaderReader(json).read();
      found = layout_fault(header, data_size);
      if (found.empty()) return header;
    } catch (const HeaderReader::Fault& fault) {
      found = fault.found;
    }
  }
  throw InputError({.what = "broken header",
                    .where = where,
                    .found = found,
                    .expected = "a tensor file (safetensors layout)",
                    .advice = "copy the file again, it may have been cut short"});
}

std::string format_header(const TensorHeader& header) {
  try {
    std::string json = "{\"" + std::string(metadata_key) + "\":" + Json(header.metadata).dump();
    for (const auto& [name, entry] : header.tensors) {
      json += "," + Json(name).dump() + ":{\"dtype\":\"" + std::string(name_of(entry.type)) +
              "\",\"shape\":" + Json(entry.shape).dump() + ",\"data_offsets\":[" +
              std::to_string(entry.begin) + "," + std::to_string(entry.end) + "]}";
    }
    json += '}';
    constexpr std::size_t alignment = 64, length_bytes = 8;
    while ((json.size() + length_bytes) % alignment != 0) json += ' ';
    return json;
  } catch (const Json::exception&) {
    throw InputError("a name or text for a tensor file is not UTF-8");
  }
}

std::string header_digest(std::string_view json) {
  const std::string mark = "\"" + std::string(header_digest_key) + "\":\"";
  const auto found = json.find(mark);
  if (found == std::string_view::npos || json.size() - found - mark.size() < digest_length) return {};
  const auto digits = found + mark.size();
  return base::Sha256().add(json.substr(0, digits)).add(json.substr(digits + digest_length)).hex();
}

}  // namespace elrom::io
