#include "vtk_array.hpp"

#include <zlib.h>

#include <array>
#include <charconv>
#include <cstring>

#include "elrom/base/error.hpp"

namespace elrom::ingest {
namespace {

constexpr std::string_view blanks = " \t\r\n";

[[noreturn]] void damaged(const std::string& where, const std::string& found, const std::string& expected) {
  throw InputError({.what = "damaged array", .where = where, .found = found, .expected = expected});
}

int digit_of(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

/// Bytes one after another. Base64 may be of several runs, each with its padding.
class Source {
 public:
  Source(std::string_view data, bool base64, std::string where)
      : data_(data), base64_(base64), where_(std::move(where)) {}

  std::string take(std::size_t n) {
    if (n > data_.size() + ready_.size())
      damaged(where_, "an end", "another " + std::to_string(n) + " bytes");
    if (!base64_) {
      const auto bytes = data_.substr(0, n);
      data_.remove_prefix(n);
      return std::string(bytes);
    }
    while (ready_.size() < n) decode_four();
    auto bytes = ready_.substr(0, n);
    ready_.erase(0, n);
    return bytes;
  }

 private:
  void decode_four() {
    std::array<int, 4> digit{};
    std::size_t n_digits = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto at = data_.find_first_not_of(blanks);
      if (at == std::string_view::npos) damaged(where_, "an end", "more base64");
      const char c = data_[at];
      data_.remove_prefix(at + 1);
      if (c == '=') continue;
      digit[i] = digit_of(c);
      if (digit[i] < 0 || n_digits != i) damaged(where_, "'" + std::string(1, c) + "'", "base64");
      ++n_digits;
    }
    if (n_digits < 2) damaged(where_, "padding", "base64");
    const auto bits = static_cast<unsigned>(digit[0] << 18 | digit[1] << 12 | digit[2] << 6 | digit[3]);
    for (std::size_t i = 0; i + 1 < n_digits; ++i) ready_ += static_cast<char>(bits >> (16 - 8 * i) & 0xff);
  }

  std::string_view data_;
  bool base64_;
  std::string where_, ready_;
};

std::uint64_t number(std::string_view bytes) {
  std::uint64_t value = 0;
  std::memcpy(&value, bytes.data(), bytes.size());  // little-endian, as this machine
  return value;
}

std::string inflate_block(const std::string& packed, std::size_t n, const std::string& where) {
  std::string bytes(n, '\0');
  uLongf size = n;
  const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (status != Z_OK || size != n) damaged(where, "compressed bytes that zlib refuses", "a whole block");
  return bytes;
}

// Header: number of blocks, bytes of a whole block, bytes of the last where it is not whole, packed bytes of
// each. https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
std::string take_compressed(Source& source, std::size_t n_bytes, const VtkEncoding& encoding) {
  const auto next = [&] { return number(source.take(encoding.header_bytes)); };
  const auto n_blocks = next(), whole = next(), last = next();
  const auto n_whole = last > 0 && n_blocks > 0 ? n_blocks - 1 : n_blocks;
  const bool fits = n_whole == 0 || (whole > 0 && n_whole <= n_bytes / whole);
  if (!fits || last > n_bytes || n_whole * whole + last != n_bytes)
    damaged(encoding.where, "blocks of another size", std::to_string(n_bytes) + " bytes");
  std::vector<std::uint64_t> packed;
  for (std::uint64_t i = 0; i < n_blocks; ++i) packed.push_back(next());
  std::string bytes;
  for (std::uint64_t i = 0; i < n_blocks; ++i) {
    const auto size = i == n_whole ? last : whole;
    bytes += inflate_block(source.take(packed[i]), size, encoding.where);
  }
  return bytes;
}

template <class T>
void append(std::string_view bytes, std::vector<double>& values) {
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + i, sizeof(T));
    values.push_back(static_cast<double>(value));
  }
}

struct VtkType {
  std::string_view name;
  std::size_t bytes;
  void (*append)(std::string_view, std::vector<double>&);
};
constexpr std::array<VtkType, 10> types{{{"Float32", 4, append<float>},
                                         {"Float64", 8, append<double>},
                                         {"Int8", 1, append<std::int8_t>},
                                         {"UInt8", 1, append<std::uint8_t>},
                                         {"Int16", 2, append<std::int16_t>},
                                         {"UInt16", 2, append<std::uint16_t>},
                                         {"Int32", 4, append<std::int32_t>},
                                         {"UInt32", 4, append<std::uint32_t>},
                                         {"Int64", 8, append<std::int64_t>},
                                         {"UInt64", 8, append<std::uint64_t>}}};

const VtkType* type_of(std::string_view name) {
  for (const auto& type : types)
    if (type.name == name) return &type;
  return nullptr;
}

}  // namespace

std::size_t bytes_of_vtk_type(std::string_view type) {
  const auto* known = type_of(type);
  return known ? known->bytes : 0;
}

std::vector<double> vtk_numbers(std::string_view text, std::size_t n, const std::string& where) {
  std::vector<double> values;
  for (auto at = text.find_first_not_of(blanks); at != std::string_view::npos;
       at = text.find_first_not_of(blanks)) {
    text.remove_prefix(at);
    const auto word = text.substr(0, text.find_first_of(blanks));
    double value = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc{} || end != word.data() + word.size())
      damaged(where, "'" + std::string(word.substr(0, 40)) + "'", "a number");
    values.push_back(value);
    text.remove_prefix(word.size());
  }
  if (values.size() != n) damaged(where, std::to_string(values.size()) + " values", std::to_string(n));
  return values;
}

std::vector<double> vtk_numbers(std::string_view data, bool base64, std::string_view type, std::size_t n,
                                const VtkEncoding& encoding) {
  const auto* known = type_of(type);
  check(known != nullptr, "an array of a known type");
  constexpr std::size_t most_packed = 1100;  // zlib makes nothing smaller than 1/1032
  const std::size_t most = encoding.compressed ? encoding.file_bytes * most_packed : encoding.file_bytes;
  if (n > most / known->bytes) damaged(encoding.where, "a smaller file", std::to_string(n) + " values");
  Source source(data, base64, encoding.where);
  const auto n_bytes = n * known->bytes;
  std::string bytes;
  if (encoding.compressed) {
    bytes = take_compressed(source, n_bytes, encoding);
  } else {
    const auto size = number(source.take(encoding.header_bytes));
    if (size != n_bytes) damaged(encoding.where, std::to_string(size) + " bytes", std::to_string(n_bytes));
    bytes = source.take(n_bytes);
  }
  std::vector<double> values;
  values.reserve(bytes.size() / known->bytes);
  known->append(bytes, values);
  return values;
}

}  // namespace elrom::ingest
