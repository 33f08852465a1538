#pragma once
// Bundles of any size with networks of random weights, for tests
// and benchmarks: shapes as trained, values meaningless.

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::test {

struct BundleSize {
  std::size_t n_x = 4, n_y = 3, n_planes = 5;
  std::size_t n_fields = 9, n_inputs = 4, n_cases = 12;
  std::size_t n_submodels = 2, n_builds = 2, n_layers = 2, n_units = 8;
  bool half_precision = false;
  bool with_uncertainty = true;
  double wave = 0;  ///< of the mean over the columns, in means: fields that the checks at the door let pass
};

inline io::Tensor random_tensor(base::Random& random, std::vector<std::size_t> shape, double scale) {
  std::size_t n = 1;
  for (const auto extent : shape) n *= extent;
  std::vector<float> values(n);
  for (auto& value : values) value = static_cast<float>(scale * random.normal());
  return io::Tensor::copy(std::span<const float>(values), std::move(shape));
}

/// Layers n_inputs -> n_units (n_layers times) -> n_outputs, weights of the size that keeps activations
/// near 1.
inline model::Network random_network(base::Random& random, std::size_t n_inputs, const BundleSize& size,
                                     std::size_t n_outputs) {
  std::vector<model::Layer> layers;
  std::size_t width = n_inputs;
  for (std::size_t i = 0; i <= size.n_layers; ++i) {
    const std::size_t next = i < size.n_layers ? size.n_units : n_outputs;
    const double scale = std::sqrt(2.0 / static_cast<double>(width));
    layers.push_back({random_tensor(random, {next, width}, scale), random_tensor(random, {next}, 0.1)});
    width = next;
  }
  return {std::move(layers), model::Activation::relu};
}

/// A column belongs to submodel (column mod n_submodels).
inline std::shared_ptr<const model::FieldModel> random_networks(const field::FieldInfo& info,
                                                                const MatrixD& inputs, const BundleSize& size,
                                                                base::Random& random) {
  model::BandedNetworks::Parts parts;
  parts.n_columns = size.n_x * size.n_y;
  parts.inputs = model::InputScaler::fit(inputs);
  parts.planes = {.kind = model::PlaneEncodingKind::fourier, .n_planes = size.n_planes};
  const auto columns = static_cast<Eigen::Index>(parts.n_columns);
  const float typical = info.name == "pressure" ? 3000.0F
                        : info.unit == "m"      ? 2e-4F
                        : info.unit == "1"      ? 0.05F
                                                : 2.0F;
  parts.outputs.mean = MatrixF::Constant(1, columns, typical);
  for (Eigen::Index c = 0; c < columns && size.wave > 0; ++c)
    parts.outputs.mean(0, c) *= 1 + static_cast<float>(size.wave * std::sin(6.28 * static_cast<double>(c) /
                                                                            static_cast<double>(columns)));
  parts.outputs.deviation = MatrixF::Constant(1, columns, 0.3F * typical);
  for (std::size_t s = 0; s < size.n_submodels; ++s) {
    model::Submodel submodel;
    submodel.name = "band " + std::to_string(s);
    for (std::size_t c = s; c < parts.n_columns; c += size.n_submodels)
      submodel.columns.push_back(static_cast<std::int32_t>(c));
    for (std::size_t b = 0; b < size.n_builds; ++b) {
      submodel.builds.push_back(
          random_network(random, size.n_inputs + parts.planes.size(), size, submodel.columns.size()));
      submodel.scores.push_back(random.uniform(0.1, 0.5));
    }
    parts.submodels.push_back(std::move(submodel));
  }
  model::BandedNetworks networks(std::move(parts));
  return std::make_shared<model::BandedNetworks>(size.half_precision ? networks.halved()
                                                                     : std::move(networks));
}

inline field::InputSchema sample_schema(std::size_t n_inputs) {
  std::vector<field::InputInfo> infos;
  for (std::size_t i = 0; i < n_inputs; ++i)
    infos.push_back({"flow_" + std::to_string(i), "kg/s", i % 2 == 0 ? "t/h" : "kg/s"});
  return field::InputSchema(std::move(infos));
}

/// Training inputs of the sample: load drives all flows together, each deviates on its own.
inline MatrixD sample_inputs(const BundleSize& size, base::Random& random) {
  MatrixD inputs(size.n_cases, size.n_inputs);
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    const double load = 0.4 + 0.6 * static_cast<double>(i) / static_cast<double>(inputs.rows() - 1);
    for (Eigen::Index j = 0; j < inputs.cols(); ++j)
      inputs(i, j) = 10.0 * static_cast<double>(j + 1) * load * random.uniform(0.9, 1.1);
  }
  return inputs;
}

inline model::Bundle sample_bundle(const BundleSize& size = {}, std::uint64_t seed = 1) {
  base::Random random(base::Seed(seed).derive("sample bundle"));
  model::Bundle bundle;
  bundle.mesh = field::make_furnace_mesh({}, size.n_x, size.n_y, size.n_planes);
  bundle.info.method = "networks";
  bundle.info.schema = sample_schema(size.n_inputs);
  bundle.info.provenance = {{"store_digest", "sample"}};
  const MatrixD inputs = sample_inputs(size, random);
  std::vector<double> loads;
  for (std::size_t i = 0; i < size.n_cases; ++i) {
    bundle.info.cases.push_back("train_" + std::to_string(i));
    loads.push_back(0.4 + 0.6 * static_cast<double>(i) / static_cast<double>(size.n_cases - 1));
  }
  bundle.guard = model::Guard(bundle.info.schema, inputs, bundle.info.cases, loads);
  for (const auto& info : field::standard_fields().first(size.n_fields)) {
    bundle.info.fields.push_back(info);
    bundle.models[info.name] = random_networks(info, inputs, size, random);
    if (!size.with_uncertainty) continue;
    MatrixF residuals(size.n_cases, bundle.mesh.n_cells());
    for (auto& value : residuals.reshaped()) value = static_cast<float>(random.normal());
    bundle.uncertainty[info.name] = std::make_shared<model::Uncertainty>(residuals, bundle.mesh.n_columns);
  }
  return bundle;
}

/// A case well inside the sample's training cases.
inline std::vector<double> sample_case(const BundleSize& size = {}) {
  std::vector<double> inputs;
  for (std::size_t j = 0; j < size.n_inputs; ++j) inputs.push_back(10.0 * static_cast<double>(j + 1) * 0.7);
  return inputs;
}

}  // namespace elrom::test
