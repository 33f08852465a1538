#include "fuzz_bundles.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <numeric>

#include "../../src/io/tensor_header.hpp"
#include "../support/random_network.hpp"
#include "elrom/base/error.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/methods/peers.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/model/mlp_coefficients.hpp"
#include "elrom/model/pod_model.hpp"
#include "elrom/model/predictor.hpp"
#include "memory_file.hpp"

namespace elrom::faults {
namespace {

namespace fs = std::filesystem;
using Model = std::shared_ptr<const model::FieldModel>;

/// Four cells, three inputs, five cases: a bundle of a few
/// kilobytes, so that a fuzzer tries thousands a second.
field::FieldData small_data(field::CaseSet& cases, const field::FieldInfo& info) {
  constexpr Eigen::Index n_cases = 5, n_cells = 4;
  cases.mesh = field::make_furnace_mesh({}, 2, 1, 2);
  cases.schema = field::InputSchema(
      {{"air_left", "kg/s", "t/h"}, {"air_right", "kg/s", "kg/s"}, {"gas_temperature", "K", "degC"}});
  base::Random random(base::Seed(3).derive("small data"));
  field::FieldData data{&cases, info, MatrixF(n_cases, n_cells)};
  cases.inputs.resize(n_cases, 3);
  for (Eigen::Index i = 0; i < n_cases; ++i) {
    const double load = 0.4 + 0.15 * static_cast<double>(i);
    cases.names.push_back("c" + std::to_string(i));
    cases.loads.push_back(load);
    cases.inputs.row(i) << 100 * load * random.uniform(0.9, 1.1), 100 * load * random.uniform(0.9, 1.1),
        1100 * random.uniform(0.98, 1.02);
    for (float& value : data.values.row(i)) value = static_cast<float>(0.3 * load + 0.05 * random.normal());
  }
  return data;
}

Model networks(const field::CaseSet& cases, bool masked) {
  model::BandedNetworks::Parts parts;
  parts.n_columns = 2;
  parts.inputs = model::InputScaler::fit(cases.inputs);
  parts.planes = {.kind = model::PlaneEncodingKind::fourier, .n_planes = 2, .n_frequencies = 1};
  parts.outputs = {MatrixF::Constant(1, 2, 0.2F), MatrixF::Constant(1, 2, 0.1F)};
  const std::size_t n_in = 3 + parts.planes.size(), n_out = masked ? 2 : 1;
  for (std::size_t s = 0; s < 2; ++s) {
    model::Submodel band{.name = std::to_string(s), .columns = {static_cast<std::int32_t>(s)}};
    if (masked) {
      band.columns = {0, 1};
      band.mask = s == 0 ? std::vector<std::uint8_t>{1, 0, 1, 0} : std::vector<std::uint8_t>{0, 1, 0, 1};
    }
    for (std::uint64_t b = 0; b < 2; ++b) {
      band.builds.push_back(
          test::random_network({n_in, 3, n_out}, model::Activation::silu, base::Seed(10 * s + b)));
      band.scores.push_back(0.1);
    }
    parts.submodels.push_back(std::move(band));
  }
  return std::make_shared<model::BandedNetworks>(std::move(parts));
}

/// @param planes of its two modes; empty: both planes
Model pod_mlp(const field::CaseSet& cases, const std::vector<model::ModePlanes>& planes = {},
              Eigen::Index n_columns = 2) {
  model::MlpCoefficients::Parts parts{
      .inputs = model::InputScaler::fit(cases.inputs),
      .scale = Eigen::VectorXd::Ones(2),
      .variance = Eigen::VectorXd::Ones(2),
      .builds = {test::random_network({3, 3, 2}, model::Activation::tanh, base::Seed(1))},
      .scores = {0.1}};
  const Eigen::Index n_cells = 2 * n_columns;
  return model::make_pod_model("pod_mlp", Eigen::VectorXd::Constant(n_cells, 0.2),
                               MatrixF::Constant(2, n_cells, 0.1F), Eigen::VectorXd::Constant(n_cells, 0.01),
                               static_cast<std::size_t>(n_columns),
                               std::make_shared<model::MlpCoefficients>(std::move(parts)), {}, {}, planes);
}

/// Every kind of model that a bundle may hold, by name.
std::map<std::string, Model> models_of(field::CaseSet& cases, const field::FieldData& data) {
  std::vector<std::size_t> rows(cases.n_cases());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  std::map<std::string, Model> models;
  for (const auto& name : methods::closed_form_peers())
    models[name] = methods::make_peer(name)->fit(data, rows, {});
  const field::MirrorDeclaration left_right{
      .name = "left-right", .axis = 'x', .swap = {{"*_left", "*_right"}}};
  cases.mirrors = {field::resolve(left_right, cases.schema, cases.mesh)};
  models["kernel"] = methods::make_kernel_method()->fit(data, rows, {});
  models["networks"] = networks(cases, false);
  models["networks_masked"] = networks(cases, true);
  models["pod_mlp"] = pod_mlp(cases);
  models["pod_of_some_planes"] = pod_mlp(cases, {{0, 2}, {1, 1}});
  models["mirror"] = std::make_shared<model::MirrorModel>(
      models["linear"], field::symmetry_group(cases.mirrors, 3, 4), data.info.parity, 2);
  models["blend"] = std::make_shared<model::BlendModel>(
      std::vector<model::BlendModel::Member>{{{0.5}, models["nearest"]}, {{0.5}, models["pod_mlp"]}});
  models["scaled"] = std::make_shared<model::ScaledModel>(
      model::FeatureMap({{"scale", {{model::FeatureTerm::Kind::logarithm, 1, {{0}, {1}, 0}, {}, 1e-3}}}},
                        cases.schema.size()),
      models["linear"]);
  const model::LinearForm both{{0, 1}, {0.5, 0.5}, 0};
  models["unfolded"] = std::make_shared<model::UnfoldedModel>(
      model::FeatureMap(
          {{"a", {{.form = both}}}, {"b", {{.form = both}}}, {"c", {{.form = {{2}, {1.0}, 0}}}}},
          cases.schema.size()),
      model::SymmetryFold(cases.mirrors, data.info.parity, {{1}}, 2, 2), pod_mlp(cases, {}, 1),
      models["kernel"]);
  models["blend_by_column"] = std::make_shared<model::BlendModel>(std::vector<model::BlendModel::Member>{
      {{0.2, 0.8}, models["linear"]}, {{0.8, 0.2}, models["nearest"]}});
  return models;
}

void load_and_predict(const fs::path& path) {
  model::BundleReader bundle(path, io::Verify::never);
  model::Selection selection;
  const auto& fields = bundle.info().fields;
  if (!fields.empty() && bundle.uncertainty(fields.front().name)) selection.interval_level = 0.5;
  const model::Predictor predictor(std::move(bundle), selection);
  std::vector<float> values(predictor.size()), width(selection.interval_level ? predictor.size() : 0);
  const std::vector<double> inputs(predictor.bundle().info().schema.size(), 1.0);
  model::Predictor::Scratch scratch;
  (void)predictor.guard().assess(inputs);
  (void)predictor.bundle().mesh();
  predictor.predict(inputs, values, width, scratch);
}

void change_text(io::TensorFile& file, Dice& dice) {
  auto entry = file.texts().begin();
  std::advance(entry, dice.below(file.texts().size()));
  auto [key, text] = *entry;
  if (text.empty()) return;
  const auto at = dice.below(text.size());
  switch (dice.below(4)) {
    case 0:
      text[at] = static_cast<char>(dice.below(256));
      break;
    case 1:
      text.erase(at, 1 + dice.below(20));
      break;
    case 2:
      text.insert(at, std::to_string(dice.below(65536) * 99991));
      break;
    default:
      text.insert(at, 1 + dice.below(200), static_cast<char>(dice.below(256)));
  }
  file.set_text(key, text);
}

void change_tensor(io::TensorFile& file, Dice& dice) {
  if (file.tensors().empty()) return;
  auto entry = file.tensors().begin();
  std::advance(entry, dice.below(file.tensors().size()));
  const auto& tensor = entry->second;
  if (tensor.type() != io::DType::f32 && tensor.type() != io::DType::f64) return;
  auto shape = tensor.shape();
  std::vector<float> values(tensor.size(), 0.5f);
  if (!values.empty()) values[dice.below(values.size())] = hard_numbers[dice.below(std::size(hard_numbers))];
  if (dice.below(2) == 1 && !shape.empty()) {
    shape[dice.below(shape.size())] = dice.below(5);
    values.assign(std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>()), 0.5f);
  }
  if (dice.below(2) == 1) {
    const std::vector<double> doubles(values.begin(), values.end());
    file.set(entry->first, io::Tensor::copy(std::span<const double>(doubles), shape));
  } else {
    file.set(entry->first, io::Tensor::copy(std::span<const float>(values), shape));
  }
}

}  // namespace

std::vector<std::uint8_t> with_true_digest(Bytes input) {
  std::vector<std::uint8_t> bytes(input.begin(), input.end());
  std::uint64_t length = 0;
  if (bytes.size() < sizeof length) return bytes;
  std::memcpy(&length, bytes.data(), sizeof length);
  if (length > bytes.size() - sizeof length) return bytes;
  char* const text = reinterpret_cast<char*>(bytes.data()) + sizeof length;
  const std::string_view json(text, length);
  const auto digest = io::header_digest(json);
  const std::string mark = "\"" + std::string(io::header_digest_key) + "\":\"";
  if (!digest.empty()) std::memcpy(text + json.find(mark) + mark.size(), digest.data(), digest.size());
  return bytes;
}

std::size_t Dice::below(std::size_t n) {
  std::size_t value = 0;
  for (int i = 0; i < 2 && at_ < input_.size(); ++i) value = value << 8 | input_[at_++];
  return n == 0 ? 0 : value % n;
}

void change(io::TensorFile& file, Dice& dice) {
  while (!dice.used_up()) {
    if (dice.below(2) == 0)
      change_text(file, dice);
    else
      change_tensor(file, dice);
  }
}

std::map<std::string, model::Bundle> small_bundles() {
  auto cases = std::make_unique<field::CaseSet>();
  const auto data = small_data(*cases, field::field_info("gas_velocity_z"));
  std::map<std::string, model::Bundle> bundles;
  for (auto& [name, one] : models_of(*cases, data)) {
    auto& bundle = bundles[name];
    bundle.info.method = name;
    bundle.info.fields = {data.info};
    bundle.info.schema = cases->schema;
    bundle.info.cases = cases->names;
    bundle.mesh = cases->mesh;
    bundle.guard = model::Guard(cases->schema, cases->inputs, cases->names, cases->loads);
    bundle.models[data.info.name] = std::move(one);
    if (name == "linear")
      bundle.uncertainty[data.info.name] = std::make_shared<model::Uncertainty>(data.values, 2);
  }
  return bundles;
}

io::TensorFile tiny_bundle() {
  io::TensorFile file;
  file.set_text("kind", "elrom-bundle");
  file.set_text("format", "1.0");
  file.set_text("bundle", R"({"method":"m","cases":[],"provenance":{},"accuracy":"","fields":[],"inputs":[],)"
                          R"("mesh":{"n_planes":1,"n_columns":1,"digest":""}})");
  file.set("mesh/centre", io::Tensor::copy(MatrixD(MatrixD::Zero(1, 3))));
  return file;
}

void fuzz_bundle(Bytes input) {
  try {
    const auto path = memory_file("any.elrom", with_true_digest(input));
    const auto file = io::TensorFile::open(path);
    try {
      file.verify_all();
    } catch (const Error&) {  // a changed tensor ends here; a bundle that is made to do harm goes on
    }
    load_and_predict(path);
  } catch (const Error&) {
  }
}

void fuzz_bundle_content(Bytes input) {
  static const std::vector<io::TensorFile> good = [] {
    std::vector<io::TensorFile> files;
    for (const auto& [name, bundle] : small_bundles()) {
      bundle.write(memory_folder() / (name + ".elrom"));
      files.push_back(io::TensorFile::open(memory_folder() / (name + ".elrom")));
    }
    return files;
  }();
  try {
    Dice dice(input);
    auto file = good[dice.below(good.size())];
    change(file, dice);
    const auto path = memory_file("content.elrom", {});
    file.write(path);
    load_and_predict(path);
  } catch (const Error&) {
  }
}

}  // namespace elrom::faults
