#include "key_figures.hpp"

#include <algorithm>
#include <limits>

namespace elrom::fields {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

KeyFigures::KeyFigures(const model::Predictor& predictor, const model::Extent& extent)
    : predictor_(predictor), cells_(extent.cells()), mesh_(predictor.bundle().mesh()) {
  settings_ = model::audit_settings(predictor.bundle().furnace());
  names_ = {"solids [kg]", "gas balance [1]", "pressure drop [Pa]", "weight of the solids [Pa]"};
  for (const auto& info : predictor.fields()) {
    for (const char* what : {" mean", " lowest", " highest"})
      names_.push_back(info.name + what + " [" + info.unit + "]");
  }
}

KeyFigures::Figures KeyFigures::of(const field::CaseInputs& inputs, std::span<const float> values) const {
  auto figures = audited(inputs, values);
  const std::size_t n = predictor_.planes().size() * predictor_.n_columns();
  for (std::size_t i = 0; i < predictor_.fields().size(); ++i) {
    const auto own = values.subspan(i * n, n);
    double sum = 0, volume = 0, lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const double value = own[cells_.place(k)],
                   weight = mesh_.volume[static_cast<std::size_t>(cells_.number(k))];
      sum += weight * value;
      volume += weight;
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
    figures.values.insert(figures.values.end(), {sum / volume, lowest, highest});
  }
  return figures;
}

KeyFigures::Figures KeyFigures::audited(const field::CaseInputs& inputs,
                                        std::span<const float> values) const {
  if (cells_.size() != mesh_.n_cells()) return {std::vector(n_audit, unknown), {}};
  const auto& info = predictor_.bundle().info();
  const auto audit = model::audit({.mesh = mesh_,
                                   .schema = info.schema,
                                   .inputs = inputs.values,
                                   .fields = predictor_.fields(),
                                   .values = values},
                                  settings_);
  return {{audit.solids_kg.value_or(unknown), audit.gas_balance.value_or(unknown),
           audit.pressure_drop.value_or(unknown), audit.solids_weight.value_or(unknown)},
          model::unusual_figures(audit, info.usual_audit)};
}

}  // namespace elrom::fields
