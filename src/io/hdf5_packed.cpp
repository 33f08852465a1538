// Chunks packed once and written many times.
#include <zlib.h>

#include "hdf5_internal.hpp"

namespace elrom::io {

using namespace detail;

namespace {

constexpr int packed_level = 9;  // packed once, when a bundle is made

/// The shuffle filter: first bytes of all values, then second bytes, ...
std::vector<std::uint8_t> shuffled(std::span<const std::byte> bytes, std::size_t value_size) {
  const std::size_t n = bytes.size() / value_size;
  std::vector<std::uint8_t> result(bytes.size());
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < value_size; ++k)
      result[k * n + i] = std::to_integer<std::uint8_t>(bytes[i * value_size + k]);
  }
  return result;
}

}  // namespace

std::vector<std::uint8_t> pack_chunk(std::span<const std::byte> values, std::size_t value_size) {
  check(value_size > 0 && values.size() % value_size == 0, "whole values");
  const auto bytes = shuffled(values, value_size);
  auto size = compressBound(bytes.size());
  std::vector<std::uint8_t> packed(size);
  check(compress2(packed.data(), &size, bytes.data(), bytes.size(), packed_level) == Z_OK, "zlib deflates");
  packed.resize(size);
  return packed;
}

template <class T>
Hdf5Dataset Hdf5Group::write_packed(const std::string& name, const Shape& shape,
                                    std::span<const std::uint8_t> chunk) const {
  auto dataset = create<T>(name, shape, {.chunk = shape, .deflate = packed_level, .shuffle = true});
  const std::vector<hsize_t> origin(shape.size(), 0);
  writable(H5Dwrite_chunk(dataset.id(), H5P_DEFAULT, 0, origin.data(), chunk.size(), chunk.data()),
           "cannot write dataset", dataset.where());
  return dataset;
}

template Hdf5Dataset Hdf5Group::write_packed<float>(const std::string&, const Shape&,
                                                    std::span<const std::uint8_t>) const;
template Hdf5Dataset Hdf5Group::write_packed<std::int32_t>(const std::string&, const Shape&,
                                                           std::span<const std::uint8_t>) const;
template Hdf5Dataset Hdf5Group::write_packed<std::uint8_t>(const std::string&, const Shape&,
                                                           std::span<const std::uint8_t>) const;

}  // namespace elrom::io
