#include "symmetric_part.hpp"

#include <cmath>

#include "elrom/math/statistics.hpp"
#include "field_parts.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;

model::FeatureMap symmetric_inputs(const field::CaseSet& cases, const SymmetryClass& symmetric) {
  std::vector<model::Feature> features;
  for (std::size_t i = 0; i < cases.schema.size(); ++i)
    features.push_back(
        {cases.schema[i].name, {{.form = project_input(cases, i, symmetric), .denominator = {}}}});
  return model::FeatureMap(std::move(features), cases.schema.size());
}

/// Columns of a mesh, of which methods ask for the cells' centres alone.
field::Mesh columns_of(const field::Mesh& whole, std::span<const std::int32_t> columns) {
  field::Mesh part{.n_planes = whole.n_planes,
                   .n_columns = columns.size(),
                   .centre = {},
                   .volume = {},
                   .points = {},
                   .corners = {}};
  std::vector<Index> cells;
  for (std::size_t plane = 0; plane < whole.n_planes; ++plane)
    for (const auto column : columns) cells.push_back(static_cast<Index>(plane * whole.n_columns) + column);
  part.centre = whole.centre(cells, Eigen::all);
  return part;
}

}  // namespace

SymmetricPart::SymmetricPart(const field::FieldData& data, std::span<const std::size_t> cases,
                             const FitContext& context)
    : domain_(*data.cases, data.info.parity, symmetry_classes(data.cases->mirrors.size())),
      inputs_(symmetric_inputs(*data.cases, symmetry_classes(data.cases->mirrors.size()).front())),
      scale_(FieldParts(data, cases, context, true).scale) {
  take_cases(*data.cases);
  data_ = {.cases = &cases_,
           .info = data.info,
           .values = domain_.project(data.values, math::all_rows(cases_.n_cases()), 0, context.n_threads)};
  const auto root = std::sqrt(static_cast<double>(orbit_size()));
  for (Index i = 0; i < data_.values.rows(); ++i) {
    const auto own = cases_.inputs.row(i);
    const double logarithm = scale_ ? scale_->value({own.data(), cases_.schema.size()}) : 0;
    data_.values.row(i) *= static_cast<float>(std::exp(-logarithm) / root);
  }
}

void SymmetricPart::take_cases(const field::CaseSet& all) {
  cases_ = all;
  cases_.mirrors.clear();
  if (!is_whole()) cases_.mesh = columns_of(all.mesh, domain_.fold().stored_columns());
  const std::size_t n = all.schema.size();
  for (Index i = 0; i < cases_.inputs.rows(); ++i)
    inputs_.evaluate({all.inputs.row(i).data(), n}, {cases_.inputs.row(i).data(), n});
}

std::size_t SymmetricPart::orbit_size() const { return domain_.n_all_cells() / domain_.n_cells(); }

std::unique_ptr<model::FieldModel> SymmetricPart::model(std::unique_ptr<model::FieldModel> own,
                                                        std::unique_ptr<model::FieldModel> asymmetry) const {
  if (scale_)
    own = std::make_unique<model::ScaledModel>(model::FeatureMap({*scale_}, own->n_inputs()), std::move(own));
  return std::make_unique<model::UnfoldedModel>(inputs_, is_whole() ? model::SymmetryFold() : domain_.fold(),
                                                std::move(own), std::move(asymmetry));
}

}  // namespace elrom::methods
