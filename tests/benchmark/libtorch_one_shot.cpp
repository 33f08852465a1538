// bench-libtorch-one-shot: the prediction that elrom-predict makes, as a program that links LibTorch: opens
// the same bundle, runs its networks for one case and writes the fields. What bench-predict compares whole
// processes with. Written as one would: tensors from the bundle's weights, all planes of a case as one batch,
// inference mode.

#include <fmt/format.h>
#include <torch/types.h>

#include <fstream>
#include <numeric>

#include "elrom/base/app.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/model/bundle.hpp"
#include "support/benchmark.hpp"

namespace {

using namespace elrom;
using ::torch::Tensor;

Tensor view_of(const io::Tensor& tensor) {
  const std::vector<std::int64_t> shape(tensor.shape().begin(), tensor.shape().end());
  const bool half = tensor.type() == io::DType::f16;
  const auto view = ::torch::from_blob(const_cast<std::byte*>(tensor.bytes().data()), shape,
                                       half ? ::torch::kFloat16 : ::torch::kFloat32);
  return half ? view.to(::torch::kFloat32) : view;
}

Tensor view_of(const MatrixF& matrix) {
  return ::torch::from_blob(const_cast<float*>(matrix.data()), {matrix.rows(), matrix.cols()});
}

Tensor forward(const model::Network& network, Tensor x) {
  for (std::size_t i = 0; i < network.layers().size(); ++i) {
    x = ::torch::linear(x, view_of(network.layers()[i].weights), view_of(network.layers()[i].bias));
    if (i + 1 == network.layers().size()) break;
    switch (network.activation()) {
      case model::Activation::relu:
        x = ::torch::relu(x);
        break;
      case model::Activation::tanh:
        x = ::torch::tanh(x);
        break;
      case model::Activation::silu:
        x = ::torch::silu(x);
        break;
    }
  }
  return x;
}

Tensor undo(const model::TargetTransform& transform, const Tensor& z) {
  switch (transform.kind) {
    case model::TransformKind::log:
      return ::torch::exp(z) - transform.scale;
    case model::TransformKind::asinh:
      return ::torch::sinh(z) * transform.scale;
    case model::TransformKind::none:
      break;
  }
  return z;
}

/// (n_planes, n_inputs + encoding)
Tensor network_inputs(const model::BandedNetworks::Parts& parts, const std::vector<double>& inputs) {
  const std::size_t n_inputs = parts.inputs.size(), n_own = parts.planes.size();
  Tensor x = ::torch::empty(
      {static_cast<std::int64_t>(parts.planes.n_planes), static_cast<std::int64_t>(n_inputs + n_own)});
  float* row = x.data_ptr<float>();
  for (std::size_t plane = 0; plane < parts.planes.n_planes; ++plane, row += n_inputs + n_own) {
    parts.inputs.apply(inputs, {row, n_inputs});
    parts.planes.encode(plane, {row + n_inputs, n_own});
  }
  return x;
}

Tensor predict(const model::BandedNetworks& model, const std::vector<double>& inputs, bool best_only) {
  const auto& parts = model.parts();
  const Tensor x = network_inputs(parts, inputs);
  const auto n_planes = static_cast<std::int64_t>(parts.planes.n_planes);
  Tensor field = ::torch::zeros({n_planes, static_cast<std::int64_t>(parts.n_columns)});
  for (const auto& submodel : parts.submodels) {
    const std::vector<std::int64_t> wide(submodel.columns.begin(), submodel.columns.end());
    const Tensor columns = ::torch::tensor(wide);
    const Tensor mean = view_of(parts.outputs.mean).index_select(1, columns);
    const Tensor deviation = view_of(parts.outputs.deviation).index_select(1, columns);
    const bool one = best_only || parts.combination == model::Combination::best;
    const std::size_t first = one ? submodel.best() : 0, n_builds = one ? 1 : submodel.builds.size();
    Tensor sum = ::torch::zeros({n_planes, columns.size(0)});
    for (std::size_t b = first; b < first + n_builds; ++b)
      sum += undo(parts.transform, mean + deviation * forward(submodel.builds[b], x));
    Tensor values = sum / static_cast<double>(n_builds);
    if (!submodel.mask.empty()) {
      const Tensor mask = ::torch::from_blob(const_cast<std::uint8_t*>(submodel.mask.data()),
                                             {n_planes, columns.size(0)}, ::torch::kUInt8);
      values = ::torch::where(mask != 0, values, field.index_select(1, columns));
    }
    field.index_copy_(1, columns, values);
  }
  return field;
}

struct Options {
  std::string bundle, cases, output;
  bool best_only = false;
};

int run(const Options& options) {
  const c10::InferenceMode inference;
  const model::BundleReader reader(options.bundle);
  const auto cases = field::read_cases(options.cases, reader.info().schema);
  std::ofstream out(options.output, std::ios::binary);
  for (const auto& info : reader.info().fields) {
    const auto model = reader.model(info.name);
    const auto* networks = dynamic_cast<const model::BandedNetworks*>(model.get());
    if (networks == nullptr)
      throw InputError(
          {.what = "field " + info.name + " is no networks model",
           .where = options.bundle,
           .found = model->kind(),
           .advice = "train with networks.mirrors=false, and use the study's peers/networks.elrom"});
    const Tensor field = predict(*networks, cases.front().values, options.best_only);
    out.write(reinterpret_cast<const char*>(field.data_ptr<float>()),
              static_cast<std::streamsize>(field.numel()) * static_cast<std::streamsize>(sizeof(float)));
  }
  out.close();
  if (!out) throw SystemError(Problem{"cannot write", options.output});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return base::run_app("bench-libtorch-one-shot", [&] {
    Options options;
    benchmark::CommandLine line(
        "One case predicted by LibTorch from a bundle of networks; raw float32, field by field");
    using enum benchmark::CommandLine::Need;
    line.add("--bundle", options.bundle, "bundle of networks", required);
    line.add("--cases", options.cases, "table of cases; the first is predicted", required);
    line.add("--output", options.output, "file for the fields, (n_fields, n_planes, n_columns)", required);
    line.add("--best", options.best_only, "the best build instead of the mean");
    if (const auto status = line.parse(argc, argv)) return *status;
    return run(options);
  });
}
