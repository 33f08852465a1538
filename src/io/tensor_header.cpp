#include "tensor_header.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::io {
namespace {

using Json = nlohmann::json;

constexpr std::size_t most_tensors = 16'384;
constexpr std::size_t most_dimensions = 8;

std::optional<DType> dtype_of(std::string_view name) {
  for (const auto type : {DType::f16, DType::f32, DType::f64, DType::i32, DType::i64, DType::u8}) {
    if (name_of(type) == name) return type;
  }
  return std::nullopt;
}

/// Accepts exactly {"__metadata__": {name: text, ...}, name: {"dtype", "shape", "data_offsets"}, ...};
/// everything else ends the parse with a sentence in `fault`. An event handler rather than a document: a
/// document would merge duplicate names, and would cost many times the header's size.
class HeaderReader final : public nlohmann::json_sax<Json> {
 public:
  TensorHeader header;
  std::string fault;

  bool null() override { return fail("null"); }
  bool boolean(bool) override { return fail("a truth value"); }
  bool number_integer(number_integer_t) override { return fail("a negative number"); }
  bool number_float(number_float_t, const string_t&) override {
    return fail("a number that is no whole number");
  }
  bool binary(binary_t&) override { return fail("binary data"); }

  bool number_unsigned(number_unsigned_t value) override {
    if (!in_list_) return fail("a number outside shape and data_offsets");
    list_.push_back(value);
    return list_.size() <= most_dimensions || fail("more than 8 numbers in a list");
  }

  bool string(string_t& text) override {
    if (depth_ == 2 && in_metadata_) {
      return header.metadata.emplace(key_, std::move(text)).second ||
             fail("metadata name '" + key_ + "' twice");
    }
    if (depth_ != 2 || key_ != "dtype" || in_list_) return fail("a text at '" + key_ + "'");
    const auto type = dtype_of(text);
    if (!type)
      return fail("type '" + text + "' of tensor '" + name_ + "' (known: F16, F32, F64, I32, I64, U8)");
    entry_.type = *type;
    return mark(1);
  }

  bool start_object(std::size_t) override {
    if (++depth_ > 2 || in_list_) return fail("an object inside '" + name_ + "'");
    if (depth_ == 2) {
      in_metadata_ = name_ == metadata_key;
      seen_ = 0;
      entry_ = {};
    }
    return true;
  }

  bool key(string_t& text) override {
    (depth_ == 1 ? name_ : key_) = std::move(text);
    return true;
  }

  bool end_object() override { return --depth_ != 1 || finish_entry(); }

  bool start_array(std::size_t) override {
    const bool expected =
        depth_ == 2 && !in_metadata_ && !in_list_ && (key_ == "shape" || key_ == "data_offsets");
    if (!expected) return fail("a list at '" + (depth_ == 2 ? key_ : name_) + "'");
    in_list_ = true;
    list_.clear();
    return true;
  }

  bool end_array() override {
    in_list_ = false;
    if (key_ == "shape") {
      entry_.shape.assign(list_.begin(), list_.end());
      return mark(2);
    }
    if (list_.size() != 2) return fail("data_offsets of tensor '" + name_ + "' without two numbers");
    entry_.begin = list_[0];
    entry_.end = list_[1];
    return mark(4);
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception&) override {
    return fail("text that is no JSON at byte " + std::to_string(position));
  }

 private:
  bool fail(std::string found) {
    if (fault.empty()) fault = std::move(found);
    return false;
  }
  bool mark(int bit) {
    if ((seen_ & bit) != 0) return fail("'" + key_ + "' of tensor '" + name_ + "' twice");
    seen_ |= bit;
    return true;
  }
  bool finish_entry() {
    if (in_metadata_) {
      if (had_metadata_) return fail("__metadata__ twice");
      had_metadata_ = true;
      in_metadata_ = false;
      return true;
    }
    if (seen_ != 7) return fail("tensor '" + name_ + "' without dtype, shape or data_offsets");
    if (header.tensors.size() >= most_tensors) return fail("more than " + std::to_string(most_tensors) + " tensors");
    return header.tensors.emplace(name_, std::move(entry_)).second || fail("tensor '" + name_ + "' twice");
  }

  int depth_ = 0;
  int seen_ = 0;  //!< bits: dtype 1, shape 2, data_offsets 4
  bool in_metadata_ = false, had_metadata_ = false, in_list_ = false;
  std::string name_, key_;
  TensorEntry entry_;
  std::vector<std::uint64_t> list_;
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
  HeaderReader reader;
  bool good = !json.empty() && json.front() == '{' && Json::sax_parse(json, &reader);
  if (good) reader.fault = layout_fault(reader.header, data_size);
  if (good && reader.fault.empty()) return std::move(reader.header);
  throw InputError({.what = "broken header",
                    .where = where,
                    .found = reader.fault.empty() ? "no JSON object" : reader.fault,
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
