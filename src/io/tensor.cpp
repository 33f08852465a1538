#include <algorithm>
#include <cstring>

#include "dtype_names.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/tensor_file.hpp"

namespace elrom::io {
namespace {

std::string describe(DType type, const std::vector<std::size_t>& shape) {
  std::vector<std::string> sizes;
  for (const auto n : shape) sizes.push_back(std::to_string(n));
  return std::string(name_of(type)) + " (" + base::join(sizes, ", ") + ")";
}

template <class T>
Tensor copy_values(DType type, std::span<const T> values, std::vector<std::size_t> shape) {
  auto bytes = std::make_shared<std::vector<T>>(values.begin(), values.end());
  const auto* data = reinterpret_cast<const std::byte*>(bytes->data());
  Tensor tensor(type, std::move(shape), bytes, data);
  check(tensor.size() == values.size(), "a tensor's shape must hold exactly its values");
  return tensor;
}

template <class Matrix>
std::vector<std::size_t> shape_of(const Matrix& values) {
  return {static_cast<std::size_t>(values.rows()), static_cast<std::size_t>(values.cols())};
}

}  // namespace

std::size_t size_of(DType type) {
  switch (type) {
    case DType::f16:
      return 2;
    case DType::f32:
    case DType::i32:
      return 4;
    case DType::f64:
    case DType::i64:
      return 8;
    case DType::u8:
      return 1;
  }
  return 1;
}

std::string_view name_of(DType type) { return dtype_names.name(type); }

Tensor::Tensor(DType type, std::vector<std::size_t> shape, std::shared_ptr<const void> owner,
               const std::byte* data)
    : type_(type), shape_(std::move(shape)), owner_(std::move(owner)), data_(data) {
  // A vector without elements may have no address; an empty tensor is still a tensor.
  static constexpr std::byte nothing{};
  if (data_ == nullptr && !shape_.empty() && size() == 0) data_ = &nothing;
}

std::size_t Tensor::size() const {
  std::size_t n = 1;
  for (const auto extent : shape_) n *= extent;
  return data_ == nullptr && shape_.empty() ? 0 : n;
}

std::span<const std::byte> Tensor::bytes() const { return {data_, size() * size_of(type_)}; }

template <class T>
static std::span<const T> values_as(const Tensor& tensor, DType wanted) {
  if (tensor.type() != wanted) {
    throw InputError({.what = "tensor of another type",
                      .found = describe(tensor.type(), tensor.shape()),
                      .expected = std::string(name_of(wanted))});
  }
  return {reinterpret_cast<const T*>(tensor.bytes().data()), tensor.size()};
}

std::span<const std::uint16_t> Tensor::f16() const { return values_as<std::uint16_t>(*this, DType::f16); }
std::span<const float> Tensor::f32() const { return values_as<float>(*this, DType::f32); }
std::span<const double> Tensor::f64() const { return values_as<double>(*this, DType::f64); }
std::span<const std::int32_t> Tensor::i32() const { return values_as<std::int32_t>(*this, DType::i32); }
std::span<const std::uint8_t> Tensor::u8() const { return values_as<std::uint8_t>(*this, DType::u8); }

template <class Map, class T>
static Map matrix_view(const Tensor& tensor, std::span<const T> values) {
  const auto& shape = tensor.shape();
  if (shape.empty() || shape.size() > 2) {
    throw InputError({.what = "tensor of another rank",
                      .found = describe(tensor.type(), shape),
                      .expected = "rank 1 or 2"});
  }
  const auto rows = shape.size() == 2 ? shape[0] : 1;
  return Map(values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(shape.back()));
}

ConstMapF Tensor::matrix() const { return matrix_view<ConstMapF>(*this, f32()); }
Eigen::Map<const MatrixD> Tensor::matrix64() const {
  return matrix_view<Eigen::Map<const MatrixD>>(*this, f64());
}

Tensor Tensor::copy(const MatrixF& values) {
  return copy_values(DType::f32, std::span(values.data(), static_cast<std::size_t>(values.size())),
                     shape_of(values));
}
Tensor Tensor::copy(const MatrixD& values) {
  return copy_values(DType::f64, std::span(values.data(), static_cast<std::size_t>(values.size())),
                     shape_of(values));
}
Tensor Tensor::copy(std::span<const float> values, std::vector<std::size_t> shape) {
  return copy_values(DType::f32, values, std::move(shape));
}
Tensor Tensor::copy(std::span<const double> values, std::vector<std::size_t> shape) {
  return copy_values(DType::f64, values, std::move(shape));
}
Tensor Tensor::copy(std::span<const std::int32_t> values, std::vector<std::size_t> shape) {
  return copy_values(DType::i32, values, std::move(shape));
}
Tensor Tensor::copy(std::span<const std::uint8_t> values, std::vector<std::size_t> shape) {
  return copy_values(DType::u8, values, std::move(shape));
}

}  // namespace elrom::io
