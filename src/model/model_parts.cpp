#include "model_parts.hpp"

#include <array>

#include "elrom/base/error.hpp"

namespace elrom::model {

nlohmann::json parse_json(const std::string& text, bool with_exceptions) {
  constexpr int most_depth = 16;
  constexpr std::size_t most_values = 100'000;
  std::size_t n = 0;
  const auto within_limits = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth <= most_depth && ++n <= most_values) return true;
    throw InputError({.what = "JSON text out of all proportion",
                      .expected = "at most " + std::to_string(most_values) + " values, " +
                                  std::to_string(most_depth) + " deep",
                      .advice = "the file is damaged or was made to do harm"});
  };
  return nlohmann::json::parse(text, within_limits, with_exceptions);
}

nlohmann::json read_description(const io::TensorFile& file, const std::string& prefix) {
  auto description = parse_json(file.text(prefix), false);
  if (!description.is_object()) {
    throw InputError({.what = "no description of a model",
                      .where = file.where() + ":" + prefix,
                      .expected = "a JSON object"});
  }
  return description;
}

std::string text_of(const nlohmann::json& description, const std::string& key, const std::string& where) {
  const auto found = description.find(key);
  if (found == description.end() || !found->is_string()) {
    throw InputError(
        {.what = "incomplete description of a model", .where = where, .expected = "a text \"" + key + "\""});
  }
  return found->get<std::string>();
}

void save_scaler(io::TensorFile& file, const std::string& prefix, const math::Standardiser& scaler) {
  save_vector(file, prefix + "/mean", scaler.mean());
  save_vector(file, prefix + "/scale", scaler.scale());
}

math::Standardiser load_scaler(const io::TensorFile& file, const std::string& prefix) {
  Eigen::VectorXd mean = load_vector(file, prefix + "/mean");
  Eigen::VectorXd scale = load_vector(file, prefix + "/scale", static_cast<std::size_t>(mean.size()));
  if (!mean.allFinite() || !(scale.array() > 0).all() || !scale.allFinite()) {
    throw InputError({.what = "scaler is not usable",
                      .where = file.where() + ":" + prefix,
                      .expected = "finite means and positive scales"});
  }
  return {std::move(mean), std::move(scale)};
}

Eigen::VectorXd load_vector(const io::TensorFile& file, const std::string& name, std::size_t n) {
  const std::array<std::size_t, 1> shape{n};
  const std::span<const double> values = file.tensor(name, shape).f64();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

MatrixD load_matrix(const io::TensorFile& file, const std::string& name, std::size_t rows,
                    std::size_t columns) {
  const std::array<std::size_t, 2> shape{rows, columns};
  return file.tensor(name, shape).matrix64();
}

void save_vector(io::TensorFile& file, const std::string& name, const Eigen::VectorXd& values) {
  const auto n = static_cast<std::size_t>(values.size());
  file.set(name, io::Tensor::copy(std::span<const double>(values.data(), n), {n}));
}

std::string shape_text(const io::Tensor& tensor) {
  std::string text;
  for (std::size_t size : tensor.shape()) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

void check_query(const Query& query, std::size_t n_planes, std::size_t n_columns,
                 std::span<const float> values, std::span<const float> spread) {
  for (std::int32_t plane : query.planes) {
    check(plane >= 0 && static_cast<std::size_t>(plane) < n_planes, "a plane that the model has not");
  }
  check(values.size() == query.planes.size() * n_columns, "size of the values asked for");
  check(spread.empty() || spread.size() == values.size(), "size of the spread asked for");
}

}  // namespace elrom::model
