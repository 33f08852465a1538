// How a networks model lies in a bundle (data/FORMATS.md, "Field model: networks").

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"
#include "elrom/model/banded_networks.hpp"
#include "model_parts.hpp"

namespace elrom::model {
namespace {

using Json = nlohmann::json;

constexpr base::EnumNames<Combination, 2> combinations{
    "combination of builds", {{Combination::mean, "mean"}, {Combination::best, "best"}}};

Json describe(const BandedNetworks::Parts& parts) {
  Json submodels = Json::array();
  for (const auto& submodel : parts.submodels)
    submodels.push_back({{"name", submodel.name},
                         {"builds", submodel.builds.size()},
                         {"scores", submodel.scores},
                         {"masked", !submodel.mask.empty()}});
  return {{"kind", "networks"},
          {"columns", parts.n_columns},
          {"planes", parts.planes.n_planes},
          {"plane_encoding", name_of(parts.planes.kind)},
          {"frequencies", parts.planes.n_frequencies},
          {"transform", name_of(parts.transform.kind)},
          {"transform_scale", parts.transform.scale},
          {"combine", combinations.name(parts.combination)},
          {"submodels", std::move(submodels)}};
}

std::vector<double> numbers(const io::TensorFile& file, const std::string& name) {
  const auto values = file.tensor(name).f64();
  return {values.begin(), values.end()};
}

/// A number of things that a file may ask for; what it asks for is checked against its tensors later on.
constexpr std::size_t size_limit = 10'000'000;

std::size_t size_of(const Json& description, const char* key) {
  const auto size = whole_number<std::size_t>(description.at(key));
  if (size == 0 || size > size_limit) throw InputError({"size out of range", key, std::to_string(size)});
  return size;
}

std::string submodel_prefix(const std::string& prefix, std::size_t i) {
  return prefix + "/submodel" + std::to_string(i);
}
std::string build_prefix(const std::string& submodel, std::size_t b) {
  return submodel + "/build" + std::to_string(b);
}

Submodel load_submodel(const io::TensorFile& file, const std::string& prefix, const Json& description,
                       std::size_t n_planes, const Wanted& wanted) {
  Submodel submodel;
  submodel.name = description.at("name").get<std::string>();
  submodel.scores = description.at("scores").get<std::vector<double>>();
  const auto columns = file.tensor(prefix + "/columns").i32();
  submodel.columns.assign(columns.begin(), columns.end());
  if (description.at("masked").get<bool>()) {
    const auto mask = file.tensor(prefix + "/mask", std::array{n_planes, columns.size()}).u8();
    submodel.mask.assign(mask.begin(), mask.end());
  }
  const auto answers_one = [&](const std::vector<std::int32_t>& planes) {
    return std::any_of(planes.begin(), planes.end(),
                       [&](std::int32_t plane) { return submodel.answers(static_cast<std::size_t>(plane)); });
  };
  const bool answers = wanted.planes.all() || answers_one(wanted.planes.numbers(n_planes));
  if (!answers) return submodel;
  const auto n_builds = size_of(description, "builds");
  if (submodel.scores.size() != n_builds)
    throw InputError({.what = "not one score a build", .where = file.where() + ":" + prefix});
  const std::size_t best = submodel.best();
  for (std::size_t b = 0; b < n_builds; ++b)
    if (!wanted.best_build_only || b == best)
      submodel.builds.push_back(Network::load(file, build_prefix(prefix, b)));
  if (wanted.best_build_only) submodel.scores = {submodel.scores[best]};
  return submodel;
}

BandedNetworks::Parts load_parts(const io::TensorFile& file, const std::string& prefix,
                                 const Json& description, const Wanted& wanted) {
  BandedNetworks::Parts parts;
  parts.n_columns = size_of(description, "columns");
  parts.planes = {plane_encoding_of(description.at("plane_encoding").get<std::string>()),
                  size_of(description, "planes"), size_of(description, "frequencies")};
  parts.transform = {transform_of(description.at("transform").get<std::string>()),
                     description.at("transform_scale").get<float>()};
  parts.combination = combinations.value(description.at("combine").get<std::string>());
  parts.inputs = {numbers(file, prefix + "/input_mean"), numbers(file, prefix + "/input_factor"),
                  numbers(file, prefix + "/input_relevance")};
  parts.outputs = {file.tensor(prefix + "/output_mean").matrix(),
                   file.tensor(prefix + "/output_deviation").matrix()};
  if (!wanted.planes.fit(parts.planes.n_planes))
    throw InputError({"fewer planes than asked for", file.where() + ":" + prefix,
                      std::to_string(parts.planes.n_planes) + " planes"});
  parts.loaded_planes = wanted.planes;
  const auto& submodels = description.at("submodels");
  for (std::size_t i = 0; i < submodels.size(); ++i) {
    auto submodel =
        load_submodel(file, submodel_prefix(prefix, i), submodels.at(i), parts.planes.n_planes, wanted);
    if (!submodel.builds.empty()) parts.submodels.push_back(std::move(submodel));
  }
  return parts;
}

}  // namespace

void BandedNetworks::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, describe(parts_).dump());
  const std::vector<std::size_t> inputs{parts_.inputs.size()};
  file.set(prefix + "/input_mean", io::Tensor::copy(std::span<const double>(parts_.inputs.mean), inputs));
  file.set(prefix + "/input_factor", io::Tensor::copy(std::span<const double>(parts_.inputs.factor), inputs));
  file.set(prefix + "/input_relevance",
           io::Tensor::copy(std::span<const double>(parts_.inputs.relevance), inputs));
  file.set(prefix + "/output_mean", io::Tensor::copy(parts_.outputs.mean));
  file.set(prefix + "/output_deviation", io::Tensor::copy(parts_.outputs.deviation));
  for (std::size_t i = 0; i < parts_.submodels.size(); ++i) {
    const auto& submodel = parts_.submodels[i];
    const std::string name = submodel_prefix(prefix, i);
    const std::size_t n_out = submodel.columns.size();
    file.set(name + "/columns", io::Tensor::copy(std::span<const std::int32_t>(submodel.columns), {n_out}));
    if (!submodel.mask.empty())
      file.set(name + "/mask", io::Tensor::copy(std::span<const std::uint8_t>(submodel.mask),
                                                {parts_.planes.n_planes, n_out}));
    for (std::size_t b = 0; b < submodel.builds.size(); ++b)
      submodel.builds[b].save(file, build_prefix(name, b));
  }
}

std::unique_ptr<FieldModel> BandedNetworks::load(const io::TensorFile& file, const std::string& prefix,
                                                 const Wanted& wanted) {
  try {
    return std::make_unique<BandedNetworks>(load_parts(file, prefix, parse_json(file.text(prefix)), wanted));
  } catch (const Json::exception& error) {
    throw InputError(
        {"unreadable description of a networks model", file.where() + ":" + prefix, error.what()});
  }
}

}  // namespace elrom::model
