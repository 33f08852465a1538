#include "elrom/model/nearest_model.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "elrom/base/error.hpp"
#include "model_parts.hpp"

namespace elrom::model {

NearestModel::NearestModel(math::Standardiser scaler, MatrixD inputs, io::Tensor values,
                           std::size_t n_columns, const std::string& where)
    : scaler_(std::move(scaler)),
      inputs_(std::move(inputs)),
      values_(std::move(values)),
      n_columns_(n_columns) {
  const bool fits = values_.shape().size() == 2 &&
                    values_.shape()[0] == static_cast<std::size_t>(inputs_.rows()) && inputs_.rows() > 0 &&
                    n_columns_ > 0 && values_.shape()[1] > 0 && values_.shape()[1] % n_columns_ == 0;
  if (!fits) {
    throw InputError(
        {.what = "cases do not fit their inputs",
         .where = where,
         .found = shape_text(values_),
         .expected = std::to_string(inputs_.rows()) + " x a multiple of " + std::to_string(n_columns_)});
  }
}

std::size_t NearestModel::nearest(std::span<const double> inputs, Workspace& workspace) const {
  const Workspace::Frame frame(workspace);
  const std::span<double> scaled = doubles(workspace, inputs.size());
  scaler_.apply(inputs, scaled);
  const Eigen::Map<const Eigen::RowVectorXd> x(scaled.data(), static_cast<Eigen::Index>(scaled.size()));
  double least = std::numeric_limits<double>::infinity();
  Eigen::Index best = 0;
  for (Eigen::Index i = 0; i < inputs_.rows(); ++i) {
    const double distance = (inputs_.row(i) - x).squaredNorm();
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return static_cast<std::size_t>(best);
}

void NearestModel::predict(const Query& query, std::span<float> values, std::span<float> spread,
                           Workspace& workspace) const {
  const std::size_t n_cells = values_.shape()[1];
  check_query(query, n_cells / n_columns_, n_columns_, values, spread);
  const float* found = values_.f32().data() + nearest(query.inputs, workspace) * n_cells;
  for (std::size_t i = 0; i < query.planes.size(); ++i) {
    std::copy_n(found + static_cast<std::size_t>(query.planes[i]) * n_columns_, n_columns_,
                values.data() + i * n_columns_);
  }
  std::fill(spread.begin(), spread.end(), 0.0F);
}

void NearestModel::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", kind()}, {"n_columns", n_columns_}}.dump());
  save_scaler(file, prefix + "/scaler", scaler_);
  file.set(prefix + "/inputs", io::Tensor::copy(inputs_));
  file.set(prefix + "/cases", values_);
}

std::unique_ptr<FieldModel> NearestModel::load(const io::TensorFile& file, const std::string& prefix,
                                               const Wanted& /*wanted*/) {
  const std::string where = file.where() + ":" + prefix;
  const nlohmann::json description = read_description(file, prefix);
  if (!description.contains("n_columns") || !description["n_columns"].is_number_unsigned()) {
    throw InputError(
        {.what = "incomplete description of a model", .where = where, .expected = "a number \"n_columns\""});
  }
  const std::array<std::size_t, 2> any{io::any_size, io::any_size};
  math::Standardiser scaler = load_scaler(file, prefix + "/scaler");
  MatrixD inputs =
      load_matrix(file, prefix + "/inputs", io::any_size, static_cast<std::size_t>(scaler.size()));
  io::Tensor cases = file.tensor(prefix + "/cases", any);
  static_cast<void>(cases.f32());
  return std::make_unique<NearestModel>(std::move(scaler), std::move(inputs), std::move(cases),
                                        description["n_columns"].get<std::size_t>(), where);
}

}  // namespace elrom::model
