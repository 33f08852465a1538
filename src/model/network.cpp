#include "elrom/model/network.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "dense_kernel.hpp"
#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"
#include "model_parts.hpp"

namespace elrom::model {
namespace {

constexpr base::EnumNames<Activation, 3> activations{
    "activation", {{Activation::relu, "relu"}, {Activation::tanh, "tanh"}, {Activation::silu, "silu"}}};

void require(bool fits, std::size_t i_layer, const std::string& found, const std::string& expected) {
  if (!fits)
    throw InputError(
        {"network does not fit together", "layer " + std::to_string(i_layer + 1), found, expected});
}

void check_layer(const Layer& layer, std::size_t i_layer) {
  const auto& w = layer.weights;
  const bool rank_two = w.shape().size() == 2 && w.shape()[0] > 0 && w.shape()[1] > 0;
  require(rank_two, i_layer, "weights of shape " + shape_text(w), "(n_out, n_in)");
  require(w.type() == io::DType::f32 || w.type() == io::DType::f16, i_layer,
          "weights of type " + std::string(io::name_of(w.type())), "F32 or F16");
  require(
      layer.bias.type() == io::DType::f32 && layer.bias.size() == w.shape()[0], i_layer,
      "bias of shape " + shape_text(layer.bias) + " and type " + std::string(io::name_of(layer.bias.type())),
      std::to_string(w.shape()[0]) + " values of type F32");
}

}  // namespace

std::string_view name_of(Activation activation) { return activations.name(activation); }
Activation activation_of(std::string_view name) { return activations.value(name); }

Network::Network(std::vector<Layer> layers, Activation activation)
    : layers_(std::move(layers)), activation_(activation) {
  if (layers_.empty()) throw InputError(Problem{"network without layers"});
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    check_layer(layers_[i], i);
    if (i == 0) continue;
    const auto produced = layers_[i - 1].weights.shape()[0];
    require(layers_[i].weights.shape()[1] == produced, i,
            "weights of shape " + shape_text(layers_[i].weights),
            std::to_string(produced) + " inputs, the outputs of the layer before");
  }
}

std::size_t Network::n_inputs() const { return layers_.empty() ? 0 : layers_.front().weights.shape()[1]; }
std::size_t Network::n_outputs() const { return layers_.empty() ? 0 : layers_.back().weights.shape()[0]; }

void Network::forward_shared(std::span<const float> shared, std::span<const float> own, std::size_t n_rows,
                             std::span<float> out, Workspace& workspace) const {
  const std::size_t stride = padded(n_rows);
  check(!layers_.empty() && shared.size() <= n_inputs(), "a network with enough inputs");
  check(own.size() == (n_inputs() - shared.size()) * stride,
        "own inputs are (n_inputs - n_shared, padded rows)");
  check(out.size() == n_outputs() * stride, "out is (n_outputs, padded rows)");
  std::size_t widest = 0;  // of the hidden layers
  for (std::size_t i = 0; i + 1 < layers_.size(); ++i)
    widest = std::max(widest, layers_[i].weights.shape()[0]);
  const Workspace::Frame frame(workspace);
  std::span<float> from = workspace.floats(widest * stride), to = workspace.floats(widest * stride);
  const std::span<const float> start = first_layer_start(shared, workspace);
  const auto run = [&](std::size_t i, const WeightView& weights, const float* in, const float* begin) {
    const bool last = i + 1 == layers_.size();
    float* result = last ? out.data() : to.data();
    dense(weights, in, stride, begin, result, workspace);
    if (last) return;
    activate(activation_, result, layers_[i].weights.shape()[0] * stride);
    std::swap(from, to);
  };
  run(0, {&layers_[0].weights, shared.size(), n_inputs() - shared.size()}, own.data(), start.data());
  for (std::size_t i = 1; i < layers_.size(); ++i)
    run(i, {&layers_[i].weights, 0, layers_[i].weights.shape()[1]}, from.data(),
        layers_[i].bias.f32().data());
}

std::span<const float> Network::first_layer_start(std::span<const float> shared, Workspace& workspace) const {
  const auto& first = layers_.front();
  const std::span<const float> bias = first.bias.f32();
  if (shared.empty()) return bias;
  const std::span<float> start = workspace.floats(bias.size());
  const Workspace::Frame frame(workspace);
  // The shared inputs as one padded row: the same kernel and so
  // the same order of additions as for any other row.
  const std::span<float> row = workspace.floats(shared.size() * lane),
                         sums = workspace.floats(bias.size() * lane);
  std::fill(row.begin(), row.end(), 0.0F);
  for (std::size_t k = 0; k < shared.size(); ++k) row[k * lane] = shared[k];
  dense({&first.weights, 0, shared.size()}, row.data(), lane, bias.data(), sums.data(), workspace);
  for (std::size_t o = 0; o < bias.size(); ++o) start[o] = sums[o * lane];
  return start;
}

void Network::forward(const Eigen::Ref<const MatrixF>& x, Eigen::Ref<MatrixF> y, Workspace& workspace) const {
  check(static_cast<std::size_t>(x.cols()) == n_inputs(), "as many columns of x as the network has inputs");
  check(static_cast<std::size_t>(y.cols()) == n_outputs() && y.rows() == x.rows(),
        "y is (rows of x, n_outputs)");
  const auto n = static_cast<std::size_t>(x.rows());
  for (std::size_t first = 0; first < n; first += block_rows) {
    const std::size_t rows = std::min(block_rows, n - first);
    const auto stride = static_cast<Eigen::Index>(padded(rows)), count = static_cast<Eigen::Index>(rows);
    const Workspace::Frame frame(workspace);
    const std::span<float> own = workspace.floats(n_inputs() * padded(rows));
    MapF transposed(own.data(), x.cols(), stride);
    transposed.leftCols(count) = x.middleRows(static_cast<Eigen::Index>(first), count).transpose();
    transposed.rightCols(stride - count).setZero();
    const std::span<float> out = workspace.floats(n_outputs() * padded(rows));
    forward_shared({}, own, rows, out, workspace);
    y.middleRows(static_cast<Eigen::Index>(first), count) =
        ConstMapF(out.data(), y.cols(), stride).leftCols(count).transpose();
  }
}

Network Network::halved() const {
  auto layers = layers_;
  for (auto& layer : layers) {
    const auto weights = layer.weights.f32();
    auto halves = std::make_shared<std::vector<Eigen::half>>(weights.begin(), weights.end());
    const auto* bytes = reinterpret_cast<const std::byte*>(halves->data());
    layer.weights = io::Tensor(io::DType::f16, layer.weights.shape(), std::move(halves), bytes);
  }
  return {std::move(layers), activation_};
}

void Network::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(
      prefix,
      nlohmann::json{{"kind", "mlp"}, {"activation", name_of(activation_)}, {"layers", layers_.size()}}
          .dump());
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const std::string layer = prefix + "/layer" + std::to_string(i);
    file.set(layer + "/weights", layers_[i].weights);
    file.set(layer + "/bias", layers_[i].bias);
  }
}

Network Network::load(const io::TensorFile& file, const std::string& prefix) {
  const auto description = parse_json(file.text(prefix), false);
  const bool readable = description.is_object() && description.contains("activation") &&
                        description["activation"].is_string() && description.contains("layers") &&
                        description["layers"].is_number_unsigned();
  if (!readable)
    throw InputError({"unreadable network", file.where() + ":" + prefix, file.text(prefix),
                      R"(JSON such as {"activation": "relu", "layers": 3})"});
  const auto n_layers = description["layers"].get<std::size_t>();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < n_layers; ++i) {
    const std::string layer = prefix + "/layer" + std::to_string(i);
    names.insert(names.end(), {layer + "/weights", layer + "/bias"});
    if (!file.has(names.back()))
      break;  // refused with its name below, before a wild number of layers fills the memory
  }
  const auto tensors = file.tensors(names);
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < n_layers; ++i) layers.push_back({tensors[2 * i], tensors[2 * i + 1]});
  try {
    return {std::move(layers), activation_of(description["activation"].get<std::string>())};
  } catch (const InputError& error) {
    throw InputError({"network " + prefix + " cannot be used", file.where(), error.what()});
  }
}

}  // namespace elrom::model
