#include "elrom/model/mlp_coefficients.hpp"

#include <algorithm>

#include "dense_kernel.hpp"
#include "elrom/base/error.hpp"
#include "model_parts.hpp"

namespace elrom::model {
namespace {

std::vector<double> to_vector(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace

MlpCoefficients::MlpCoefficients(Parts parts) : parts_(std::move(parts)) {
  const bool sized = !parts_.builds.empty() && parts_.scores.size() == parts_.builds.size() &&
                     parts_.variance.size() == parts_.scale.size() &&
                     parts_.inputs.factor.size() == n_inputs() &&
                     parts_.inputs.relevance.size() == n_inputs();
  if (!sized) throw InputError(Problem{"parts of a coefficient network do not fit"});
  for (const auto& build : parts_.builds) {
    if (build.n_inputs() == n_inputs() && build.n_outputs() == n_coefficients()) continue;
    throw InputError({.what = "a coefficient network does not fit",
                      .found = std::to_string(build.n_inputs()) + " inputs, " +
                               std::to_string(build.n_outputs()) + " outputs",
                      .expected = std::to_string(n_inputs()) + " and " + std::to_string(n_coefficients())});
  }
}

void MlpCoefficients::predict(std::span<const double> inputs, std::span<double> coefficients,
                              std::span<double> variance, bool best_build_only, Workspace& workspace) const {
  const std::size_t best = static_cast<std::size_t>(
      std::min_element(parts_.scores.begin(), parts_.scores.end()) - parts_.scores.begin());
  const std::size_t first = best_build_only ? best : 0, n_builds = best_build_only ? 1 : parts_.builds.size();
  const std::size_t n = n_coefficients();
  const Workspace::Frame frame(workspace);
  const std::span<float> x = workspace.floats(n_inputs()), out = workspace.floats(n * lane);
  const std::span<double> squares = doubles(workspace, n);
  parts_.inputs.apply(inputs, x);
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  for (std::size_t b = 0; b < n_builds; ++b) {
    parts_.builds[first + b].forward_shared(x, {}, 1, out, workspace);
    for (std::size_t j = 0; j < n; ++j) {
      const double value = parts_.scale[static_cast<Eigen::Index>(j)] * static_cast<double>(out[j * lane]);
      // Welford: mean and sum of squared deviations of the builds so far.
      const double step = value - coefficients[j];
      coefficients[j] += step / static_cast<double>(b + 1);
      squares[j] += step * (value - coefficients[j]);
    }
  }
  for (std::size_t j = 0; j < variance.size(); ++j)
    variance[j] = std::max(parts_.variance[static_cast<Eigen::Index>(j)],
                           n_builds > 1 ? squares[j] / static_cast<double>(n_builds - 1) : 0.0);
}

void MlpCoefficients::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(
      prefix, nlohmann::json{{"kind", kind()}, {"scores", parts_.scores}, {"recipe", parts_.recipe}}.dump());
  save_vector(file, prefix + "/input_mean", to_eigen(parts_.inputs.mean));
  save_vector(file, prefix + "/input_factor", to_eigen(parts_.inputs.factor));
  save_vector(file, prefix + "/input_relevance", to_eigen(parts_.inputs.relevance));
  save_vector(file, prefix + "/scale", parts_.scale);
  save_vector(file, prefix + "/variance", parts_.variance);
  for (std::size_t b = 0; b < parts_.builds.size(); ++b)
    parts_.builds[b].save(file, prefix + "/build" + std::to_string(b));
}

std::unique_ptr<CoefficientModel> MlpCoefficients::load(const io::TensorFile& file,
                                                        const std::string& prefix) {
  const auto description = read_description(file, prefix);
  Parts parts;
  try {
    parts.scores = description.at("scores").get<std::vector<double>>();
    parts.recipe = description.value("recipe", "");
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        {"unreadable description of coefficient networks", file.where() + ":" + prefix, error.what()});
  }
  parts.inputs = {to_vector(load_vector(file, prefix + "/input_mean")),
                  to_vector(load_vector(file, prefix + "/input_factor")),
                  to_vector(load_vector(file, prefix + "/input_relevance"))};
  parts.scale = load_vector(file, prefix + "/scale");
  parts.variance = load_vector(file, prefix + "/variance");
  for (std::size_t b = 0; b < parts.scores.size(); ++b)
    parts.builds.push_back(Network::load(file, prefix + "/build" + std::to_string(b)));
  return std::make_unique<MlpCoefficients>(std::move(parts));
}

}  // namespace elrom::model
