#pragma once
// Small things that the stored models share: descriptions, scalers, scratch memory in double.

#include <Eigen/Core>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>

#include "elrom/base/error.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/math/standardiser.hpp"
#include "elrom/model/field_model.hpp"

namespace elrom::model {

/// n doubles from a workspace, 64-byte aligned, set to zero.
[[nodiscard]] inline std::span<double> doubles(Workspace& workspace, std::size_t n) {
  const std::span<float> raw = workspace.floats(2 * n);
  double* first = reinterpret_cast<double*>(raw.data());
  std::uninitialized_fill_n(first, n, 0.0);
  return {first, n};
}

/// nlohmann::json::parse for texts of a bundle, which may be made to do harm: a document costs up to fifty
/// times its text. @throws InputError for more values, or deeper ones, than any bundle of ours holds
[[nodiscard]] nlohmann::json parse_json(const std::string& text, bool with_exceptions = true);

/// A whole number. nlohmann's own get() turns 2e199 into any int (undefined in C++).
/// @throws InputError for a fraction, a text or a number that does not fit
template <class Integer>
[[nodiscard]] Integer whole_number(const nlohmann::json& value) {
  if (value.is_number_unsigned() && std::in_range<Integer>(value.get<std::uint64_t>()))
    return static_cast<Integer>(value.get<std::uint64_t>());
  if (value.is_number_integer() && !value.is_number_unsigned() &&
      std::in_range<Integer>(value.get<std::int64_t>()))
    return static_cast<Integer>(value.get<std::int64_t>());
  throw InputError({.what = "no whole number in the description of a model", .found = value.dump()});
}

/// The JSON object under `prefix`. @throws InputError naming file and key
[[nodiscard]] nlohmann::json read_description(const io::TensorFile& file, const std::string& prefix);
/// A text of the description. @throws InputError when it is missing or no text
[[nodiscard]] std::string text_of(const nlohmann::json& description, const std::string& key,
                                  const std::string& where);

void save_scaler(io::TensorFile& file, const std::string& prefix, const math::Standardiser& scaler);
/// @throws InputError, also for a scale that is not positive
[[nodiscard]] math::Standardiser load_scaler(const io::TensorFile& file, const std::string& prefix);

/// A rank-1 tensor of `n` doubles.
[[nodiscard]] Eigen::VectorXd load_vector(const io::TensorFile& file, const std::string& name,
                                          std::size_t n = io::any_size);
/// A rank-2 tensor of doubles; either size may be io::any_size.
[[nodiscard]] MatrixD load_matrix(const io::TensorFile& file, const std::string& name, std::size_t rows,
                                  std::size_t columns);
void save_vector(io::TensorFile& file, const std::string& name, const Eigen::VectorXd& values);

/// "3 x 4" of a tensor, for messages.
[[nodiscard]] std::string shape_text(const io::Tensor& tensor);
/// @throws std::logic_error unless every plane is below n_planes and the buffers fit (a caller's mistake)
void check_query(const Query& query, std::size_t n_planes, std::size_t n_columns,
                 std::span<const float> values, std::span<const float> spread);

}  // namespace elrom::model
