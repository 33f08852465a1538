#include "elrom/methods/warm_start.hpp"

#include <algorithm>
#include <iterator>

#include "elrom/model/composite_models.hpp"
#include "elrom/model/pod_model.hpp"

namespace elrom::methods {
namespace {

/// The coefficients of this type that the model is of, or a part of its blend.
template <class Coefficients>
const Coefficients* part_of(const model::FieldModel* model) {
  if (const auto* modes = dynamic_cast<const model::PodModel*>(model))
    return dynamic_cast<const Coefficients*>(&modes->coefficients());
  if (const auto* scaled = dynamic_cast<const model::ScaledModel*>(model))
    return part_of<Coefficients>(scaled->model().get());
  const auto* blend = dynamic_cast<const model::BlendModel*>(model);
  if (blend == nullptr) return nullptr;
  for (const auto& member : blend->members())
    if (const auto* found = part_of<Coefficients>(member.model.get())) return found;
  return nullptr;
}

}  // namespace

std::vector<std::size_t> WarmStart::known_among(std::span<const std::size_t> rows) const {
  std::vector<std::size_t> both;
  std::ranges::set_intersection(known, rows, std::back_inserter(both));
  return both;
}

const model::SmootherCoefficients* WarmStart::smoother() const {
  return part_of<model::SmootherCoefficients>(model.get());
}

const model::MlpCoefficients* WarmStart::mlp() const { return part_of<model::MlpCoefficients>(model.get()); }

}  // namespace elrom::methods
