#include "hdf5_internal.hpp"

#include <algorithm>
#include <new>
#include <utility>

namespace elrom::io::detail {

namespace {

/// The library does not survive its own start when memory runs out there; so we find that out first.
bool enough_memory_to_start() {
  constexpr std::size_t more_than_it_takes = std::size_t{4} << 20;
  ::operator delete(::operator new(more_than_it_takes));
  return true;
}

}  // namespace

void quiet() {
  // Every file is closed by its owner. The library's own clearing-up at exit would crash on a file that could
  // not be written (a full disk), after the error has been told.
  static const bool no_exit_handler = enough_memory_to_start() && H5dont_atexit() >= 0;
  (void)no_exit_handler;
  thread_local const bool done = (H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), true);
  (void)done;
}

std::string last_cause() {
  std::string cause;
  const auto keep_first = [](unsigned, const H5E_error2_t* error, void* data) -> herr_t {
    auto& text = *static_cast<std::string*>(data);
    if (text.empty() && error->desc != nullptr) text = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first, &cause);
  std::replace(cause.begin(), cause.end(), '\n', ' ');
  // The library's file driver tells times, addresses and sizes; the system's own words in it are what helps.
  constexpr std::string_view quoted = "error message = '";
  const auto begin = cause.find(quoted);
  if (begin == std::string::npos) return cause;
  const auto text = cause.substr(begin + quoted.size());
  return text.substr(0, text.find('\''));
}

hid_t readable(hid_t result, std::string_view what, const std::string& where) {
  if (result < 0) throw InputError({.what = std::string(what), .where = where, .found = last_cause()});
  return result;
}

hid_t writable(hid_t result, std::string_view what, const std::string& where) {
  if (result < 0) throw SystemError({.what = std::string(what), .where = where, .found = last_cause()});
  return result;
}

template <>
hid_t native_type<float>() {
  return H5T_NATIVE_FLOAT;
}
template <>
hid_t native_type<double>() {
  return H5T_NATIVE_DOUBLE;
}
template <>
hid_t native_type<std::int32_t>() {
  return H5T_NATIVE_INT32;
}
template <>
hid_t native_type<std::int64_t>() {
  return H5T_NATIVE_INT64;
}
template <>
hid_t native_type<std::uint8_t>() {
  return H5T_NATIVE_UINT8;
}

TextType text_type_of(hid_t file_type, const std::string& where) {
  if (H5Tget_class(file_type) != H5T_STRING) {
    throw InputError({.what = "not a text", .where = where, .expected = "a string"});
  }
  TextType text;
  text.variable = H5Tis_variable_str(file_type) > 0;
  // The file's own character set: the library refuses to convert between ASCII and UTF-8.
  text.type = Hdf5Id(readable(H5Tcopy(file_type), "cannot read text", where));
  if (!text.variable) text.size = H5Tget_size(file_type);
  return text;
}

Hdf5Id make_text_type(std::size_t size, bool ascii) {
  Hdf5Id type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.get(), std::max<std::size_t>(size, 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
  return type;
}

bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 128; });
}

TextBlock pack_texts(std::span<const std::string> values) {
  std::size_t size = 1;
  bool ascii = true;
  for (const auto& value : values) {
    size = std::max(size, value.size());
    ascii = ascii && is_ascii(value);
  }
  TextBlock block{std::string(size * values.size(), '\0'), make_text_type(size, ascii)};
  for (std::size_t i = 0; i < values.size(); ++i) values[i].copy(block.bytes.data() + i * size, size);
  return block;
}

}  // namespace elrom::io::detail
