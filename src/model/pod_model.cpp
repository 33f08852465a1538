#include "elrom/model/pod_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elrom/base/error.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

void refuse(const std::string& where, const std::string& what, const io::Tensor& found,
            const std::string& expected) {
  throw InputError({.what = what, .where = where, .found = shape_text(found), .expected = expected});
}

/// out += sum over four modes; four at a time so that `out` is read and written once for four rows.
void add_four(const float* modes, std::size_t n, const float* c, float* out) {
  const float *m0 = modes, *m1 = modes + n, *m2 = modes + 2 * n, *m3 = modes + 3 * n;
  for (std::size_t j = 0; j < n; ++j) out[j] += c[0] * m0[j] + c[1] * m1[j] + c[2] * m2[j] + c[3] * m3[j];
}

void add_one(const float* mode, std::size_t n, float c, float* out) {
  for (std::size_t j = 0; j < n; ++j) out[j] += c * mode[j];
}

void add_square(const float* mode, std::size_t n, float variance, float* out) {
  for (std::size_t j = 0; j < n; ++j) out[j] += variance * (mode[j] * mode[j]);
}

/// (n_modes, n_planes * n_columns) to (n_planes, n_modes, n_columns).
io::Tensor by_plane(const MatrixF& modes, std::size_t n_columns) {
  const auto n_modes = static_cast<std::size_t>(modes.rows()),
             n_cells = static_cast<std::size_t>(modes.cols());
  const std::size_t n_planes = n_cells / n_columns;
  std::vector<float> ordered(n_modes * n_cells);
  for (std::size_t p = 0; p < n_planes; ++p) {
    for (std::size_t m = 0; m < n_modes; ++m) {
      std::copy_n(modes.data() + m * n_cells + p * n_columns, n_columns,
                  ordered.data() + (p * n_modes + m) * n_columns);
    }
  }
  return io::Tensor::copy(std::span<const float>(ordered), {n_planes, n_modes, n_columns});
}

io::Tensor cells(const Eigen::VectorXd& values, std::size_t n_columns) {
  const Eigen::VectorXf narrow = values.cast<float>();
  const auto n = static_cast<std::size_t>(values.size());
  return io::Tensor::copy(std::span<const float>(narrow.data(), n), {n / n_columns, n_columns});
}

}  // namespace

PodModel::PodModel(Parts parts, const std::string& where) : parts_(std::move(parts)) {
  if (parts_.mean.shape().size() != 2)
    refuse(where, "mean of the wrong rank", parts_.mean, "planes x columns");
  n_planes_ = parts_.mean.shape()[0];
  n_columns_ = parts_.mean.shape()[1];
  n_modes_ = parts_.coefficients->n_coefficients();
  if (parts_.modes.shape() != std::vector{n_planes_, n_modes_, n_columns_}) {
    refuse(where, "modes do not fit mean and coefficients", parts_.modes,
           std::to_string(n_planes_) + " x " + std::to_string(n_modes_) + " x " + std::to_string(n_columns_));
  }
  if (!parts_.residual.empty() && parts_.residual.shape() != parts_.mean.shape()) {
    refuse(where, "residual does not fit the mean", parts_.residual, shape_text(parts_.mean));
  }
}

void PodModel::predict(const Query& query, std::span<float> values, std::span<float> spread,
                       Workspace& workspace) const {
  check_query(query, n_planes_, n_columns_, values, spread);
  const Workspace::Frame frame(workspace);
  const std::span<double> exact = doubles(workspace, n_modes_);
  const std::span<double> variance = doubles(workspace, spread.empty() ? 0 : n_modes_);
  parts_.coefficients->predict(query.inputs, exact, variance, query.best_build_only, workspace);
  const std::span<float> c = workspace.floats(n_modes_);
  std::transform(exact.begin(), exact.end(), c.begin(), [](double v) { return static_cast<float>(v); });

  const float* mean = parts_.mean.f32().data();
  const float* modes = parts_.modes.f32().data();
  const std::size_t n = n_columns_;
  for (std::size_t i = 0; i < query.planes.size(); ++i) {
    const auto plane = static_cast<std::size_t>(query.planes[i]);
    const float* plane_modes = modes + plane * n_modes_ * n;
    float* out = values.data() + i * n;
    std::copy_n(mean + plane * n, n, out);
    std::size_t m = 0;
    for (; m + 4 <= n_modes_; m += 4) add_four(plane_modes + m * n, n, c.data() + m, out);
    for (; m < n_modes_; ++m) add_one(plane_modes + m * n, n, c[m], out);
    if (spread.empty()) continue;

    float* s = spread.data() + i * n;
    std::fill_n(s, n, 0.0F);
    if (!parts_.residual.empty()) add_square(parts_.residual.f32().data() + plane * n, n, 1.0F, s);
    for (m = 0; m < n_modes_; ++m) add_square(plane_modes + m * n, n, static_cast<float>(variance[m]), s);
    for (std::size_t j = 0; j < n; ++j) s[j] = std::sqrt(s[j]);
  }
}

void PodModel::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", parts_.kind}}.dump());
  file.set(prefix + "/mean", parts_.mean);
  file.set(prefix + "/modes", parts_.modes);
  if (!parts_.residual.empty()) file.set(prefix + "/residual", parts_.residual);
  parts_.coefficients->save(file, prefix + "/coefficients");
}

const std::vector<std::string>& PodModel::kinds() {
  static const std::vector<std::string> kinds{"linear",  "pod_gp",  "pod_gp_per_mode",
                                              "pod_rbf", "pod_mlp", "kernel"};
  return kinds;
}

std::unique_ptr<FieldModel> PodModel::load(const io::TensorFile& file, const std::string& prefix) {
  const std::array<std::size_t, 2> plane{0, 0};
  const std::array<std::size_t, 3> modes{0, 0, 0};
  Parts parts{.kind = text_of(read_description(file, prefix), "kind", file.where() + ":" + prefix),
              .mean = file.tensor(prefix + "/mean", plane),
              .modes = file.tensor(prefix + "/modes", modes),
              .residual = {},
              .coefficients = load_coefficient_model(file, prefix + "/coefficients")};
  if (file.has(prefix + "/residual")) parts.residual = file.tensor(prefix + "/residual", plane);
  // Of the right type here, so that predict() never meets a wrong one.
  static_cast<void>(parts.mean.f32());
  static_cast<void>(parts.modes.f32());
  if (!parts.residual.empty()) static_cast<void>(parts.residual.f32());
  return std::make_unique<PodModel>(std::move(parts), file.where() + ":" + prefix);
}

std::unique_ptr<PodModel> make_pod_model(std::string kind, const Eigen::VectorXd& mean, const MatrixF& modes,
                                         const Eigen::VectorXd& residual, std::size_t n_columns,
                                         std::shared_ptr<const CoefficientModel> coefficients) {
  check(n_columns > 0 && mean.size() % static_cast<Eigen::Index>(n_columns) == 0, "columns divide the cells");
  return std::make_unique<PodModel>(
      PodModel::Parts{.kind = std::move(kind),
                      .mean = cells(mean, n_columns),
                      .modes = by_plane(modes, n_columns),
                      .residual = residual.size() == 0 ? io::Tensor{} : cells(residual, n_columns),
                      .coefficients = std::move(coefficients)});
}

}  // namespace elrom::model
