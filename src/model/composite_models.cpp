#include "elrom/model/composite_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "elrom/base/error.hpp"
#include "elrom/model/pod_model.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

constexpr std::size_t most_parts = 64;  // a file that asks for more is not one of ours

std::size_t count_of(const nlohmann::json& description, const std::string& key, const std::string& where) {
  const auto found = description.find(key);
  if (found == description.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() == 0 ||
      found->get<std::uint64_t>() > most_parts) {
    throw InputError({.what = "incomplete description of a model",
                      .where = where,
                      .expected = "\"" + key + "\" between 1 and " + std::to_string(most_parts)});
  }
  return found->get<std::size_t>();
}

std::string size_text(const FieldModel& model) {
  return fmt::format("{} inputs, {} planes, {} columns", model.n_inputs(), model.n_planes(),
                     model.n_columns());
}

}  // namespace

BlendModel::BlendModel(std::vector<Member> parts, const std::string& where) : parts_(std::move(parts)) {
  const auto fits = [this](const Member& part) {
    return part.model->n_inputs() == n_inputs() && part.model->n_planes() == n_planes() &&
           part.model->n_columns() == n_columns() &&
           (part.weights.size() == 1 || part.weights.size() == n_columns()) &&
           std::ranges::all_of(part.weights, [](double weight) { return std::isfinite(weight); });
  };
  if (parts_.empty() || !std::ranges::all_of(parts_, fits)) {
    throw InputError({.what = "blend of models that do not fit together",
                      .where = where,
                      .expected = "at least one model, the same inputs, planes and columns, finite weights: "
                                  "one a model or one a column"});
  }
}

void BlendModel::predict(const Query& query, std::span<float> values, std::span<float> spread,
                         Workspace& workspace) const {
  std::fill(values.begin(), values.end(), 0.0F);
  std::fill(spread.begin(), spread.end(), 0.0F);
  for (const Member& part : parts_) {
    const Workspace::Frame frame(workspace);
    const std::span<float> own = workspace.floats(values.size()),
                           own_spread = workspace.floats(spread.size()),
                           weights = workspace.floats(n_columns());
    part.model->predict(query, own, own_spread, workspace);
    for (std::size_t c = 0; c < weights.size(); ++c)
      weights[c] = static_cast<float>(part.weights[c % part.weights.size()]);
    for (std::size_t first = 0; first < values.size(); first += n_columns())
      for (std::size_t c = 0; c < weights.size(); ++c) values[first + c] += weights[c] * own[first + c];
    for (std::size_t first = 0; first < spread.size(); first += n_columns())
      for (std::size_t c = 0; c < weights.size(); ++c)
        spread[first + c] += std::abs(weights[c]) * own_spread[first + c];
  }
}

std::unique_ptr<FieldModel> BlendModel::without_case(std::size_t i_case) const {
  auto parts = parts_;
  bool any = false;
  for (Member& part : parts) {
    auto reduced = part.model->without_case(i_case);
    if (!reduced) continue;
    part.model = std::move(reduced);
    any = true;
  }
  return any ? std::make_unique<BlendModel>(std::move(parts)) : nullptr;
}

std::string scale_of(const FieldModel& model) {
  if (const auto* scaled = dynamic_cast<const ScaledModel*>(&model))
    return scaled->logarithm().features().front().name;
  if (const auto* unfolded = dynamic_cast<const UnfoldedModel*>(&model)) return scale_of(*unfolded->model());
  if (const auto* blend = dynamic_cast<const BlendModel*>(&model))
    for (const auto& part : blend->members())
      if (auto found = scale_of(*part.model); !found.empty()) return found;
  return "";
}

std::unique_ptr<FieldModel> with_case(const FieldModel& model, std::span<const double> inputs,
                                      std::span<const float> values) {
  if (const auto* modes = dynamic_cast<const PodModel*>(&model)) return modes->with_case(inputs, values);
  if (const auto* scaled = dynamic_cast<const ScaledModel*>(&model)) {
    std::vector<float> own(values.begin(), values.end());
    const float scale = scaled->scale(inputs);
    for (float& value : own) value /= scale;
    auto changed = with_case(*scaled->model(), inputs, own);
    return changed ? std::make_unique<ScaledModel>(scaled->logarithm(), std::move(changed)) : nullptr;
  }
  const auto* blend = dynamic_cast<const BlendModel*>(&model);
  if (blend == nullptr) return nullptr;
  auto parts = blend->members();
  bool any = false;
  for (auto& part : parts) {
    auto changed = with_case(*part.model, inputs, values);
    if (!changed) continue;
    part.model = std::move(changed);
    any = true;
  }
  return any ? std::make_unique<BlendModel>(std::move(parts)) : nullptr;
}

void BlendModel::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", kind()}, {"parts", parts_.size()}}.dump());
  const bool by_column = std::ranges::any_of(parts_, [](const Member& p) { return p.weights.size() > 1; });
  std::vector<double> weights;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    auto own = parts_[i].weights;
    if (by_column && own.size() == 1) own.assign(n_columns(), own.front());
    weights.insert(weights.end(), own.begin(), own.end());
    parts_[i].model->save(file, prefix + "/part" + std::to_string(i));
  }
  std::vector<std::size_t> shape{parts_.size()};
  if (by_column) shape.push_back(n_columns());
  file.set(prefix + "/weights", io::Tensor::copy(std::span<const double>(weights), shape));
}

std::unique_ptr<FieldModel> BlendModel::load(const io::TensorFile& file, const std::string& prefix,
                                             const Wanted& wanted) {
  const std::string where = file.where() + ":" + prefix;
  const std::size_t n = count_of(read_description(file, prefix), "parts", where);
  std::vector<std::size_t> shape{n};
  if (file.tensor(prefix + "/weights").shape().size() > 1) shape.push_back(io::any_size);
  const std::span<const double> weights = file.tensor(prefix + "/weights", shape).f64();
  const auto per_part = static_cast<std::ptrdiff_t>(weights.size() / n);
  std::vector<Member> parts;
  for (std::size_t i = 0; i < n; ++i) {
    const auto first = weights.begin() + static_cast<std::ptrdiff_t>(i) * per_part;
    parts.push_back(
        {{first, first + per_part}, load_field_model(file, prefix + "/part" + std::to_string(i), wanted)});
  }
  return std::make_unique<BlendModel>(std::move(parts), where);
}

ScaledModel::ScaledModel(FeatureMap logarithm, std::shared_ptr<const FieldModel> model,
                         const std::string& where)
    : logarithm_(std::move(logarithm)), model_(std::move(model)) {
  if (logarithm_.size() == 1 && logarithm_.n_inputs() == n_inputs()) return;
  throw InputError({.what = "scale of a model does not fit it",
                    .where = where,
                    .found = std::to_string(logarithm_.size()) + " features of " +
                             std::to_string(logarithm_.n_inputs()) + " inputs",
                    .expected = "one of " + std::to_string(n_inputs()) + " inputs"});
}

float ScaledModel::scale(std::span<const double> inputs) const {
  return static_cast<float>(std::exp(logarithm_.features().front().value(inputs)));
}

void ScaledModel::predict(const Query& query, std::span<float> values, std::span<float> spread,
                          Workspace& workspace) const {
  model_->predict(query, values, spread, workspace);
  const float factor = scale(query.inputs);
  for (float& v : values) v *= factor;
  for (float& s : spread) s *= factor;
}

std::unique_ptr<FieldModel> ScaledModel::without_case(std::size_t i_case) const {
  auto reduced = model_->without_case(i_case);
  return reduced ? std::make_unique<ScaledModel>(logarithm_, std::move(reduced)) : nullptr;
}

void ScaledModel::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", "scaled"}}.dump());
  logarithm_.save(file, prefix + "/logarithm");
  model_->save(file, prefix + "/model");
}

std::unique_ptr<FieldModel> ScaledModel::load(const io::TensorFile& file, const std::string& prefix,
                                              const Wanted& wanted) {
  return std::make_unique<ScaledModel>(FeatureMap::load(file, prefix + "/logarithm"),
                                       load_field_model(file, prefix + "/model", wanted),
                                       file.where() + ":" + prefix);
}

namespace {

/// Where each column of a plane comes from; the same for all planes: one row.
io::Tensor column_tensor(const field::Mirror& mirror, std::size_t n_planes, std::size_t n_columns) {
  std::vector<std::int32_t> columns(n_planes * n_columns);
  check(mirror.cell_from.size() == columns.size(), "mirror: number of cells");
  bool same = true;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto from = static_cast<std::size_t>(mirror.cell_from[c]);
    if (from / n_columns != c / n_columns) {
      throw InputError(
          {.what = "mirror '" + mirror.name + "' moves cells to another plane", .expected = "planes kept"});
    }
    columns[c] = static_cast<std::int32_t>(from % n_columns);
    same = same && columns[c] == columns[c % n_columns];
  }
  if (same) columns.resize(n_columns);
  return io::Tensor::copy(std::span<const std::int32_t>(columns), {columns.size() / n_columns, n_columns});
}

io::Tensor doubles_of(const std::vector<double>& values) {
  return io::Tensor::copy(std::span<const double>(values), {values.size()});
}

void check_indices(const io::Tensor& indices, std::size_t below, const std::string& where) {
  for (std::int32_t i : indices.i32()) {
    if (i < 0 || static_cast<std::size_t>(i) >= below) {
      throw InputError({.what = "index of a mirror image out of range",
                        .where = where,
                        .found = std::to_string(i),
                        .expected = "0 to " + std::to_string(below) + " exclusive"});
    }
  }
}

}  // namespace

MirrorModel::MirrorModel(std::shared_ptr<const FieldModel> model, const std::vector<field::Mirror>& group,
                         field::Parity parity, std::size_t n_planes)
    : model_(std::move(model)) {
  check(!group.empty(), "mirror model: a group of at least the identity");
  for (const field::Mirror& mirror : group) {
    images_.push_back(
        {io::Tensor::copy(std::span<const std::int32_t>(mirror.input_from), {mirror.input_from.size()}),
         doubles_of(mirror.input_sign), doubles_of(mirror.input_offset),
         column_tensor(mirror, n_planes, model_->n_columns()),
         static_cast<float>(mirror.field_sign(parity))});
  }
}

void MirrorModel::add_image(const Image& image, const Query& query, std::span<float> values,
                            std::span<float> spread, Workspace& workspace) const {
  const Workspace::Frame frame(workspace);
  const std::span<double> inputs = doubles(workspace, query.inputs.size());
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto from = static_cast<std::size_t>(image.input_from.i32()[i]);
    inputs[i] = image.offset.f64()[i] + image.input_sign.f64()[i] * query.inputs[from];
  }
  const std::span<float> own = workspace.floats(values.size()), own_spread = workspace.floats(spread.size());
  model_->predict({inputs, query.planes, query.best_build_only}, own, own_spread, workspace);

  const std::size_t n = n_columns();
  const bool one_map = image.column_from.shape()[0] == 1;
  for (std::size_t p = 0; p < query.planes.size(); ++p) {
    const std::size_t row = one_map ? 0 : static_cast<std::size_t>(query.planes[p]);
    const std::int32_t* from = image.column_from.i32().data() + row * n;
    for (std::size_t c = 0; c < n; ++c) {
      const std::size_t at = p * n + static_cast<std::size_t>(from[c]);
      values[p * n + c] += image.field_sign * own[at];
      if (!spread.empty()) spread[p * n + c] += own_spread[at];
    }
  }
}

void MirrorModel::predict(const Query& query, std::span<float> values, std::span<float> spread,
                          Workspace& workspace) const {
  check(images_.front().input_from.size() == query.inputs.size(), "mirror model: number of inputs");
  std::fill(values.begin(), values.end(), 0.0F);
  std::fill(spread.begin(), spread.end(), 0.0F);
  for (const Image& image : images_) add_image(image, query, values, spread, workspace);
  const float share = 1.0F / static_cast<float>(images_.size());
  for (float& v : values) v *= share;
  for (float& s : spread) s *= share;
}

void MirrorModel::save(io::TensorFile& file, const std::string& prefix) const {
  nlohmann::json signs = nlohmann::json::array();
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const std::string image = prefix + "/image" + std::to_string(i);
    signs.push_back(images_[i].field_sign);
    file.set(image + "/input_from", images_[i].input_from);
    file.set(image + "/input_sign", images_[i].input_sign);
    file.set(image + "/input_offset", images_[i].offset);
    file.set(image + "/column_from", images_[i].column_from);
  }
  file.set_text(prefix,
                nlohmann::json{{"kind", kind()}, {"images", images_.size()}, {"field_signs", signs}}.dump());
  model_->save(file, prefix + "/model");
}

std::unique_ptr<FieldModel> MirrorModel::load(const io::TensorFile& file, const std::string& prefix,
                                              const Wanted& wanted) {
  const std::string where = file.where() + ":" + prefix;
  const nlohmann::json description = read_description(file, prefix);
  const std::size_t n = count_of(description, "images", where);
  const auto signs = description.find("field_signs");
  if (signs == description.end() || !signs->is_array() || signs->size() != n ||
      !std::all_of(signs->begin(), signs->end(), [](const auto& s) { return s.is_number(); })) {
    throw InputError(
        {.what = "incomplete description of a model", .where = where, .expected = "one field sign an image"});
  }
  std::unique_ptr<MirrorModel> mirror(new MirrorModel());
  mirror->model_ = load_field_model(file, prefix + "/model", wanted);
  const std::size_t n_inputs = mirror->n_inputs();
  for (std::size_t i = 0; i < n; ++i) {
    const std::string image = prefix + "/image" + std::to_string(i);
    const std::array<std::size_t, 1> inputs{n_inputs};
    const std::array<std::size_t, 2> columns{io::any_size, mirror->n_columns()};
    Image part{file.tensor(image + "/input_from", inputs), file.tensor(image + "/input_sign", inputs),
               file.tensor(image + "/input_offset", inputs), file.tensor(image + "/column_from", columns),
               (*signs)[i].get<float>()};
    const std::size_t n_maps = part.column_from.shape()[0];
    if (part.input_from.size() != n_inputs || part.input_sign.f64().size() != n_inputs ||
        part.offset.f64().size() != n_inputs || (n_maps != 1 && n_maps != mirror->n_planes())) {
      throw InputError(
          {.what = "parts of a mirror image do not fit together", .where = file.where() + ":" + image});
    }
    check_indices(part.input_from, n_inputs, image);
    check_indices(part.column_from, mirror->n_columns(), image);
    mirror->images_.push_back(std::move(part));
  }
  return mirror;
}

UnfoldedModel::UnfoldedModel(FeatureMap symmetric, SymmetryFold fold, std::shared_ptr<const FieldModel> model,
                             std::shared_ptr<const FieldModel> asymmetry, const std::string& where)
    : symmetric_(std::move(symmetric)),
      fold_(std::move(fold)),
      model_(std::move(model)),
      asymmetry_(std::move(asymmetry)) {
  const bool fold_fits = fold_.empty() || (fold_.n_orbits() == model_->n_columns() && fold_.n_classes() > 0);
  const bool model_fits = fold_fits && symmetric_.size() == model_->n_inputs();
  if (!model_fits) {
    throw InputError(
        {.what = "model of a symmetric part does not fit its mesh",
         .where = where,
         .found = std::to_string(symmetric_.size()) + " inputs, " + std::to_string(fold_.n_orbits()) +
                  " orbits of columns",
         .expected = std::to_string(model_->n_inputs()) + " and " + std::to_string(model_->n_columns())});
  }
  if (asymmetry_ && (asymmetry_->n_inputs() != n_inputs() || asymmetry_->n_planes() != n_planes() ||
                     asymmetry_->n_columns() != n_columns())) {
    throw InputError({.what = "asymmetry of another size than the symmetric part",
                      .where = where,
                      .found = size_text(*asymmetry_),
                      .expected = size_text(*this)});
  }
}

void UnfoldedModel::predict_symmetric(const Query& query, std::span<float> values, std::span<float> spread,
                                      Workspace& workspace) const {
  const Workspace::Frame frame(workspace);
  const std::span<double> inputs = doubles(workspace, symmetric_.size());
  symmetric_.evaluate(query.inputs, inputs);
  const Query own{inputs, query.planes, query.best_build_only};
  if (fold_.empty()) return model_->predict(own, values, spread, workspace);

  const std::size_t n = n_columns(), n_own = model_->n_columns();
  const std::span<float> own_values = workspace.floats(query.planes.size() * n_own),
                         own_spread = workspace.floats(spread.empty() ? 0 : own_values.size());
  model_->predict(own, own_values, own_spread, workspace);
  std::ranges::fill(values, 0.0F);
  std::ranges::fill(spread, 0.0F);
  for (std::size_t p = 0; p < query.planes.size(); ++p) {
    fold_.add(0, own_values.subspan(p * n_own, n_own), values.subspan(p * n, n));
    if (!spread.empty()) fold_.add_squares(0, own_spread.subspan(p * n_own, n_own), spread.subspan(p * n, n));
  }
}

void UnfoldedModel::predict(const Query& query, std::span<float> values, std::span<float> spread,
                            Workspace& workspace) const {
  predict_symmetric(query, values, spread, workspace);
  if (!asymmetry_) return;
  const Workspace::Frame frame(workspace);
  const std::span<float> own_values = workspace.floats(values.size()),
                         own_spread = workspace.floats(spread.size());
  asymmetry_->predict(query, own_values, own_spread, workspace);
  std::ranges::transform(values, own_values, values.begin(), std::plus());
  std::ranges::transform(spread, own_spread, spread.begin(), std::plus());
}

void UnfoldedModel::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", "unfolded"}, {"asymmetry", asymmetry_ != nullptr}}.dump());
  symmetric_.save(file, prefix + "/symmetric");
  fold_.save(file, prefix + "/fold");
  model_->save(file, prefix + "/model");
  if (asymmetry_) asymmetry_->save(file, prefix + "/asymmetry");
}

std::unique_ptr<FieldModel> UnfoldedModel::load(const io::TensorFile& file, const std::string& prefix,
                                                const Wanted& wanted) {
  const std::string where = file.where() + ":" + prefix;
  const nlohmann::json description = read_description(file, prefix);
  const auto has_asymmetry = description.find("asymmetry");
  if (has_asymmetry == description.end() || !has_asymmetry->is_boolean())
    throw InputError({.what = "incomplete description of a model",
                      .where = where,
                      .expected = "\"asymmetry\": true or false"});
  std::unique_ptr<FieldModel> asymmetry;
  if (has_asymmetry->get<bool>()) asymmetry = load_field_model(file, prefix + "/asymmetry", wanted);
  return std::make_unique<UnfoldedModel>(
      FeatureMap::load(file, prefix + "/symmetric"), SymmetryFold::load(file, prefix + "/fold"),
      load_field_model(file, prefix + "/model", wanted), std::move(asymmetry), where);
}

}  // namespace elrom::model
