#include "elrom/particle/document_model.hpp"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::particle {
namespace {

constexpr Eigen::Index n_components = 6;

void check_part(const DocumentPart& part, const std::string& where) {
  const auto& scaler = part.inputs;
  const bool fits = part.trees.n_inputs() == n_components && part.trees.n_outputs() == n_components &&
                    scaler.mean().size() == n_components && scaler.scale().size() == n_components;
  if (!fits)
    throw InputError(
        {.what = "a part of a document model that does not take and give six velocity components",
         .where = where,
         .found = fmt::format("{} inputs, {} outputs, {} means", part.trees.n_inputs(),
                              part.trees.n_outputs(), scaler.mean().size())});
  if (!scaler.mean().allFinite() || !scaler.scale().allFinite() || !(scaler.scale().minCoeff() > 0))
    throw InputError({.what = "means or scales of velocities that cannot be used", .where = where});
}

void write_part(io::TensorFile& file, const std::string& prefix, const DocumentPart& part) {
  const auto set = [&](const char* name, const Eigen::VectorXd& values) {
    file.set(prefix + name, io::Tensor::copy(std::span<const double>(values.data(), n_components),
                                             {static_cast<std::size_t>(n_components)}));
  };
  set("/scaler/mean", part.inputs.mean());
  set("/scaler/scale", part.inputs.scale());
  part.trees.write(file, prefix + "/trees");
}

DocumentPart read_part(const io::TensorFile& file, const std::string& prefix) {
  const auto get = [&](const char* name) {
    const auto values = file.tensor(prefix + name, std::array{static_cast<std::size_t>(n_components)}).f64();
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), n_components));
  };
  return {{get("/scaler/mean"), get("/scaler/scale")}, std::move(*Trees::read(file, prefix + "/trees"))};
}

Table rows_of(const Table& table, const std::vector<Eigen::Index>& rows) { return table(rows, Eigen::all); }

// Whether a collision happens: the spheres approach and every number is finite.
Eigen::Array<bool, Eigen::Dynamic, 1> collides(const Pairs& pairs, const Table& velocities) {
  const auto approach =
      ((pairs.before.velocity_2 - pairs.before.velocity_1) * pairs.normal).rowwise().sum().eval();
  const auto sizes = (pairs.diameter_1 + pairs.diameter_2 + pairs.density_1 + pairs.density_2).eval();
  return approach < 0 && approach.isFinite() && sizes.isFinite() && velocities.isFinite().rowwise().all();
}

}  // namespace

Table six_velocities(const Motion& motion) {
  Table table(motion.velocity_1.rows(), n_components);
  table << motion.velocity_1, motion.velocity_2;
  return table;
}

Table DocumentPart::evaluate(const Table& velocities) const {
  const Table scaled = (velocities.rowwise() - inputs.mean().transpose().array()).rowwise() /
                       inputs.scale().transpose().array();
  Table after(velocities.rows(), n_components);
  trees.evaluate(scaled, after);
  return after;
}

DocumentModel::DocumentModel(DocumentPart full, std::optional<Low> low, const std::string& where)
    : full_(std::move(full)), low_(std::move(low)) {
  check_part(full_, where);
  if (!low_) return;
  check_part(low_->part, where);
  if (!(low_->speed > 0) || !std::isfinite(low_->speed))
    throw InputError({.what = "greatest speed of the model for slow pairs",
                      .where = where,
                      .found = base::number(low_->speed),
                      .expected = "a number above 0, m/s"});
}

std::string DocumentModel::text() const {
  const auto n_trees = full_.trees.n_trees() + (low_ ? low_->part.trees.n_trees() : 0);
  return fmt::format("document, {} trees{}", n_trees,
                     low_ ? fmt::format(", slow pairs (to {} m/s) apart", base::rounded(low_->speed)) : "");
}

Table DocumentModel::velocities_after(const Table& velocities) const {
  check(velocities.cols() == n_components, "document model: six velocity components");
  if (!low_) return full_.evaluate(velocities);
  const auto speed = [&](Eigen::Index first) {
    return velocities.middleCols(first, 3).square().rowwise().sum().sqrt().eval();
  };
  const Eigen::ArrayXd fastest = speed(0).max(speed(3));
  std::vector<Eigen::Index> slow, fast;
  for (Eigen::Index i = 0; i < fastest.size(); ++i) (fastest[i] <= low_->speed ? slow : fast).push_back(i);
  Table after(velocities.rows(), n_components);
  after(slow, Eigen::all) = low_->part.evaluate(rows_of(velocities, slow));
  after(fast, Eigen::all) = full_.evaluate(rows_of(velocities, fast));
  return after;
}

void DocumentModel::impulses(const Pairs& pairs, Impulses& impulses) const {
  impulses = Impulses(pairs.size());
  const Table before = six_velocities(pairs.before);
  const auto colliding = collides(pairs, before);
  const Table change = velocities_after(before) - before;
  for (Eigen::Index i = 0; i < before.rows(); ++i) {
    if (!colliding[i]) continue;
    impulses.linear_1.row(i) =
        sphere_mass(pairs.diameter_1[i], pairs.density_1[i]) * change.row(i).leftCols(3);
    impulses.linear_2.row(i) =
        sphere_mass(pairs.diameter_2[i], pairs.density_2[i]) * change.row(i).rightCols(3);
  }
}

void DocumentModel::write(io::TensorFile& file) const {
  write_part(file, "document/full", full_);
  if (!low_) return;
  file.set_text("document/low_speed", base::number(low_->speed));
  write_part(file, "document/low", low_->part);
}

std::unique_ptr<DocumentModel> DocumentModel::read(const io::TensorFile& file) {
  std::optional<Low> low;
  if (file.has_text("document/low_speed")) {
    const auto speed = base::to_double(file.text("document/low_speed"));
    low = Low{speed.value_or(-1), read_part(file, "document/low")};
  }
  return std::make_unique<DocumentModel>(read_part(file, "document/full"), std::move(low),
                                         file.where() + ":document");
}

}  // namespace elrom::particle
