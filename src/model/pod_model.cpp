#include "elrom/model/pod_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "elrom/base/error.hpp"
#include "elrom/model/smoother_coefficients.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

void refuse(const std::string& where, const std::string& what, const io::Tensor& found,
            const std::string& expected) {
  throw InputError({.what = what, .where = where, .found = shape_text(found), .expected = expected});
}

/// @throws InputError when the fold is of another mesh, or modes are of classes that it does not have
void check_fold(const PodModel::Parts& parts, std::size_t n_modes, std::size_t n_columns,
                const std::string& where) {
  if (parts.fold.empty()) return;
  const auto known = [&](std::int32_t c) {
    return c >= 0 && static_cast<std::size_t>(c) < parts.fold.n_classes();
  };
  if (parts.fold.n_columns() != n_columns || parts.class_of_mode.size() != n_modes ||
      !std::ranges::all_of(parts.class_of_mode, known)) {
    throw InputError({.what = "symmetry fold does not fit mean and modes", .where = where});
  }
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

/// Row by row as the model keeps them. @param modes (n_modes, n_planes * n_columns)
/// @return (n_rows, n_columns), or n_orbits for n_columns with a fold
io::Tensor stored(const MatrixF& modes, std::size_t n_columns, const SymmetryFold& fold,
                  std::span<const std::int32_t> first_row, std::span<const std::int32_t> mode_of) {
  const std::size_t width = fold.empty() ? n_columns : fold.n_orbits();
  std::vector<float> rows(mode_of.size() * width);
  for (std::size_t p = 0; p + 1 < first_row.size(); ++p) {
    for (auto r = static_cast<std::size_t>(first_row[p]); std::cmp_less(r, first_row[p + 1]); ++r) {
      const std::span<const float> from(modes.row(mode_of[r]).data() + p * n_columns, n_columns);
      const std::span<float> to(rows.data() + r * width, width);
      if (fold.empty())
        std::ranges::copy(from, to.begin());
      else
        fold.pick(from, to);
    }
  }
  return io::Tensor::copy(std::span<const float>(rows), {mode_of.size(), width});
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
  const std::size_t width = parts_.fold.empty() ? n_columns_ : parts_.fold.n_orbits();
  if (!parts_.first_row.empty()) {
    check_rows(where);
  } else if (parts_.modes.shape() != std::vector{n_planes_, n_modes_, width}) {
    refuse(where, "modes do not fit mean and coefficients", parts_.modes,
           std::to_string(n_planes_) + " x " + std::to_string(n_modes_) + " x " + std::to_string(width));
  }
  check_fold(parts_, n_modes_, n_columns_, where);
  if (!parts_.residual.empty() && parts_.residual.shape() != parts_.mean.shape()) {
    refuse(where, "residual does not fit the mean", parts_.residual, shape_text(parts_.mean));
  }
}

void PodModel::check_rows(const std::string& where) const {
  const auto& first = parts_.first_row;
  const std::size_t n_rows = parts_.mode_of.size(),
                    width = parts_.fold.empty() ? n_columns_ : parts_.fold.n_orbits();
  const auto known = [&](std::int32_t m) { return m >= 0 && std::cmp_less(m, n_modes_); };
  if (first.size() != n_planes_ + 1 || first.front() != 0 || std::cmp_not_equal(first.back(), n_rows) ||
      !std::ranges::is_sorted(first) || !std::ranges::all_of(parts_.mode_of, known) ||
      parts_.modes.shape() != std::vector{n_rows, width}) {
    refuse(where, "rows of modes do not fit mean and coefficients", parts_.modes,
           std::to_string(n_rows) + " x " + std::to_string(width) + ", of modes below " +
               std::to_string(n_modes_));
  }
}

PodModel::Rows PodModel::rows_of(std::size_t plane) const {
  if (parts_.first_row.empty()) return {plane * n_modes_, n_modes_};
  const auto first = static_cast<std::size_t>(parts_.first_row[plane]);
  return {first, static_cast<std::size_t>(parts_.first_row[plane + 1]) - first};
}

std::size_t PodModel::mode_of(std::size_t row) const {
  return parts_.mode_of.empty() ? row % n_modes_ : static_cast<std::size_t>(parts_.mode_of[row]);
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
  const std::size_t n = n_columns_;
  const std::span<float> v = workspace.floats(variance.size());
  std::ranges::transform(variance, v.begin(), [](double value) { return static_cast<float>(value); });
  for (std::size_t i = 0; i < query.planes.size(); ++i) {
    const auto plane = static_cast<std::size_t>(query.planes[i]);
    const auto out = values.subspan(i * n, n);
    std::copy_n(mean + plane * n, n, out.begin());
    add_modes(plane, c, false, out, workspace);
    if (spread.empty()) continue;

    const auto s = spread.subspan(i * n, n);
    std::ranges::fill(s, 0.0F);
    if (!parts_.residual.empty()) add_square(parts_.residual.f32().data() + plane * n, n, 1.0F, s.data());
    add_modes(plane, v, true, s, workspace);
    for (float& deviation : s) deviation = std::sqrt(deviation);
  }
}

void PodModel::add_modes_everywhere(std::span<const float> weights, std::span<float> out) const {
  Workspace workspace;
  for (std::size_t plane = 0; plane < n_planes_; ++plane)
    add_modes(plane, weights, false, out.subspan(plane * n_columns_, n_columns_), workspace);
}

std::unique_ptr<FieldModel> PodModel::of_other_cases(std::shared_ptr<const CoefficientModel> coefficients,
                                                     const Eigen::VectorXd& mean_shift) const {
  const Eigen::VectorXf shift = mean_shift.cast<float>();
  const auto found = parts_.mean.f32();
  std::vector<float> mean(found.begin(), found.end());
  add_modes_everywhere({shift.data(), n_modes_}, mean);
  Parts parts = parts_;
  parts.mean = io::Tensor::copy(std::span<const float>(mean), parts_.mean.shape());
  parts.coefficients = std::move(coefficients);
  return std::make_unique<PodModel>(std::move(parts));
}

std::unique_ptr<FieldModel> PodModel::without_case(std::size_t i_case) const {
  const auto* smoother = dynamic_cast<const SmootherCoefficients*>(parts_.coefficients.get());
  if (smoother == nullptr || smoother->n_cases() < 2) return nullptr;
  const auto changed = smoother->without_case(i_case);
  return of_other_cases(changed.coefficients, changed.mean_shift);
}

std::unique_ptr<FieldModel> PodModel::with_case(std::span<const double> inputs,
                                                std::span<const float> values) const {
  const auto* smoother = dynamic_cast<const SmootherCoefficients*>(parts_.coefficients.get());
  if (smoother == nullptr) return nullptr;
  const auto n = static_cast<Eigen::Index>(values.size());
  const Eigen::VectorXf departure =
      Eigen::VectorXf::Map(values.data(), n) - Eigen::VectorXf::Map(parts_.mean.f32().data(), n);
  Eigen::VectorXd coefficients(static_cast<Eigen::Index>(n_modes_));
  Eigen::VectorXf mode(n), unit(static_cast<Eigen::Index>(n_modes_));
  for (Eigen::Index m = 0; m < unit.size(); ++m) {
    mode.setZero();
    unit = Eigen::VectorXf::Unit(unit.size(), m);
    add_modes_everywhere({unit.data(), n_modes_}, {mode.data(), values.size()});
    coefficients[m] = departure.cast<double>().dot(mode.cast<double>());
  }
  const auto changed = smoother->with_case(inputs, coefficients);
  return of_other_cases(changed.coefficients, changed.mean_shift);
}

void PodModel::add_modes(std::size_t plane, std::span<const float> weights, bool squares,
                         std::span<float> out, Workspace& workspace) const {
  const bool folded = !parts_.fold.empty();
  const std::size_t n = parts_.modes.shape().back();
  const auto [first, n_rows] = rows_of(plane);
  const float* rows = parts_.modes.f32().data() + first * n;
  const Workspace::Frame frame(workspace);
  const std::span<float> own = workspace.floats(n_rows);
  for (std::size_t r = 0; r < n_rows; ++r) own[r] = weights[mode_of(first + r)];
  const auto class_of = [&](std::size_t r) { return parts_.class_of_mode[mode_of(first + r)]; };
  const auto sum = folded ? workspace.floats(n) : out;
  // Runs of modes of one class; without a fold all modes are one run.
  for (std::size_t begin = 0, end; begin < n_rows; begin = end) {
    end = folded ? begin + 1 : n_rows;
    while (end < n_rows && class_of(end) == class_of(begin)) ++end;
    if (folded) std::ranges::fill(sum, 0.0F);
    std::size_t r = begin;
    for (; squares && r < end; ++r) add_square(rows + r * n, n, own[r], sum.data());
    for (; r + 4 <= end; r += 4) add_four(rows + r * n, n, own.data() + r, sum.data());
    for (; r < end; ++r) add_one(rows + r * n, n, own[r], sum.data());
    if (!folded) continue;
    const auto i_class = static_cast<std::size_t>(class_of(begin));
    squares ? parts_.fold.add_squares(i_class, sum, out) : parts_.fold.add(i_class, sum, out);
  }
}

void PodModel::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", parts_.kind}}.dump());
  file.set(prefix + "/mean", parts_.mean);
  file.set(prefix + "/modes", parts_.modes);
  const auto set = [&](const std::string& name, const std::vector<std::int32_t>& values) {
    file.set(prefix + name, io::Tensor::copy(std::span<const std::int32_t>(values), {values.size()}));
  };
  if (!parts_.first_row.empty()) {
    set("/first_row", parts_.first_row);
    set("/mode_of", parts_.mode_of);
  }
  if (!parts_.residual.empty()) file.set(prefix + "/residual", parts_.residual);
  parts_.coefficients->save(file, prefix + "/coefficients");
  if (parts_.fold.empty()) return;
  parts_.fold.save(file, prefix + "/fold");
  set("/fold/class_of_mode", parts_.class_of_mode);
}

const std::vector<std::string>& PodModel::kinds() {
  static const std::vector<std::string> kinds{"linear",  "pod_gp",  "pod_gp_per_mode",
                                              "pod_rbf", "pod_mlp", "kernel"};
  return kinds;
}

std::unique_ptr<FieldModel> PodModel::load(const io::TensorFile& file, const std::string& prefix,
                                           const Wanted& /*wanted*/) {
  const std::array<std::size_t, 2> plane{io::any_size, io::any_size};
  const std::array<std::size_t, 3> modes{io::any_size, io::any_size, io::any_size};
  const bool by_row = file.has(prefix + "/first_row");
  const auto whole_numbers = [&](const std::string& name) {
    const std::array<std::size_t, 1> any{io::any_size};
    const auto tensor = file.tensor(prefix + name, any);
    return std::vector<std::int32_t>(tensor.i32().begin(), tensor.i32().end());
  };
  Parts parts{.kind = text_of(read_description(file, prefix), "kind", file.where() + ":" + prefix),
              .mean = file.tensor(prefix + "/mean", plane),
              .modes = by_row ? file.tensor(prefix + "/modes", plane) : file.tensor(prefix + "/modes", modes),
              .residual = {},
              .coefficients = load_coefficient_model(file, prefix + "/coefficients"),
              .fold = SymmetryFold::load(file, prefix + "/fold")};
  if (!parts.fold.empty()) parts.class_of_mode = whole_numbers("/fold/class_of_mode");
  if (by_row) {
    parts.first_row = whole_numbers("/first_row");
    parts.mode_of = whole_numbers("/mode_of");
  }
  if (file.has(prefix + "/residual")) parts.residual = file.tensor(prefix + "/residual", plane);
  // Of the right type here, so that predict() never meets a wrong one.
  static_cast<void>(parts.mean.f32());
  static_cast<void>(parts.modes.f32());
  if (!parts.residual.empty()) static_cast<void>(parts.residual.f32());
  return std::make_unique<PodModel>(std::move(parts), file.where() + ":" + prefix);
}

std::unique_ptr<PodModel> make_pod_model(std::string kind, const Eigen::VectorXd& mean, const MatrixF& modes,
                                         const Eigen::VectorXd& residual, std::size_t n_columns,
                                         std::shared_ptr<const CoefficientModel> coefficients,
                                         SymmetryFold fold, std::vector<std::int32_t> class_of_mode,
                                         std::span<const ModePlanes> planes_of_mode) {
  check(n_columns > 0 && mean.size() % static_cast<Eigen::Index>(n_columns) == 0, "columns divide the cells");
  const auto n_planes = static_cast<std::size_t>(mean.size()) / n_columns;
  const auto n_modes = static_cast<std::size_t>(modes.rows());
  std::vector<std::int32_t> first_row{0}, mode_of;
  for (std::size_t p = 0; p < n_planes; ++p) {
    for (std::size_t m = 0; m < n_modes; ++m) {
      const auto [first, n] = planes_of_mode.empty() ? ModePlanes{0, n_planes} : planes_of_mode[m];
      if (p >= first && p < first + n) mode_of.push_back(static_cast<std::int32_t>(m));
    }
    first_row.push_back(static_cast<std::int32_t>(mode_of.size()));
  }
  PodModel::Parts parts{.kind = std::move(kind),
                        .mean = cells(mean, n_columns),
                        .modes = stored(modes, n_columns, fold, first_row, mode_of),
                        .residual = residual.size() == 0 ? io::Tensor{} : cells(residual, n_columns),
                        .coefficients = std::move(coefficients),
                        .fold = std::move(fold),
                        .class_of_mode = std::move(class_of_mode)};
  if (mode_of.size() < n_planes * n_modes) {
    parts.first_row = std::move(first_row);
    parts.mode_of = std::move(mode_of);
  } else {
    parts.modes = io::Tensor::copy(parts.modes.f32(), {n_planes, n_modes, parts.modes.shape()[1]});
  }
  return std::make_unique<PodModel>(std::move(parts));
}

}  // namespace elrom::model
