#include "elrom/model/banded_networks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dense_kernel.hpp"
#include "elrom/base/error.hpp"

namespace elrom::model {
namespace {

/// Values of the table of encoded planes: a thousand planes one-hot. No furnace has more; a hostile file may
/// say so.
constexpr std::size_t most_encodings = 1'000'000;

void require(bool fits, const std::string& what, const std::string& found, const std::string& expected) {
  if (!fits) throw InputError({"parts of a networks model do not fit", what, found, expected});
}

void check_submodel(const Submodel& submodel, const BandedNetworks::Parts& parts) {
  const std::size_t n_out = submodel.columns.size(), n_in = parts.inputs.size() + parts.planes.size();
  const std::string where = "submodel " + submodel.name;
  require(!submodel.builds.empty() && submodel.builds.size() == submodel.scores.size(), where,
          std::to_string(submodel.builds.size()) + " builds, " + std::to_string(submodel.scores.size()) +
              " scores",
          "a score for each of one or more builds");
  for (const auto& network : submodel.builds)
    require(
        network.n_inputs() == n_in && network.n_outputs() == n_out, where,
        std::to_string(network.n_inputs()) + " inputs, " + std::to_string(network.n_outputs()) + " outputs",
        std::to_string(n_in) + " inputs, " + std::to_string(n_out) + " outputs");
  require(submodel.mask.empty() || submodel.mask.size() == parts.planes.n_planes * n_out, where,
          std::to_string(submodel.mask.size()) + " mask values",
          std::to_string(parts.planes.n_planes * n_out));
}

/// Planes in which the cover may differ: without masks, any plane stands for all.
std::vector<std::int32_t> planes_to_check(const BandedNetworks::Parts& parts) {
  const bool masked = std::any_of(parts.submodels.begin(), parts.submodels.end(),
                                  [](const Submodel& submodel) { return !submodel.mask.empty(); });
  if (!masked) return {0};
  return parts.loaded_planes.numbers(parts.planes.n_planes);
}

void check_cover(const BandedNetworks::Parts& parts) {
  for (const auto& submodel : parts.submodels)
    for (const auto column : submodel.columns)
      if (column < 0 || static_cast<std::size_t>(column) >= parts.n_columns)
        require(false, "submodel " + submodel.name, "column " + std::to_string(column),
                "0 to " + std::to_string(parts.n_columns - 1));
  std::vector<int> answers(parts.n_columns);
  for (const auto plane : planes_to_check(parts)) {
    std::fill(answers.begin(), answers.end(), 0);
    for (const auto& submodel : parts.submodels)
      for (std::size_t j = 0; j < submodel.columns.size(); ++j)
        if (submodel.answers(static_cast<std::size_t>(plane), j))
          ++answers[static_cast<std::size_t>(submodel.columns[j])];
    const auto wrong = std::find_if(answers.begin(), answers.end(), [](int n) { return n != 1; });
    if (wrong == answers.end()) continue;
    require(false, "plane " + std::to_string(plane) + ", column " + std::to_string(wrong - answers.begin()),
            std::to_string(*wrong) + " submodels", "one");
  }
}

}  // namespace

std::size_t Submodel::best() const {
  return static_cast<std::size_t>(std::min_element(scores.begin(), scores.end()) - scores.begin());
}

bool Submodel::answers(std::size_t plane) const {
  if (mask.empty()) return true;
  const auto* row = mask.data() + plane * columns.size();
  return std::any_of(row, row + columns.size(), [](std::uint8_t bit) { return bit != 0; });
}

BandedNetworks::BandedNetworks(Parts parts) : parts_(std::move(parts)) {
  const auto rows = static_cast<std::size_t>(parts_.outputs.mean.rows());
  require(parts_.n_columns > 0 && parts_.planes.n_planes > 0, "sizes", "no cells", "planes and columns");
  require(parts_.inputs.factor.size() == parts_.inputs.size() &&
              parts_.inputs.relevance.size() == parts_.inputs.size(),
          "input scaler", "parts of different lengths", "one mean, factor and relevance an input");
  const bool scaled = static_cast<std::size_t>(parts_.outputs.mean.cols()) == parts_.n_columns &&
                      parts_.outputs.deviation.cols() == parts_.outputs.mean.cols() &&
                      parts_.outputs.deviation.rows() == parts_.outputs.mean.rows();
  require(scaled && (rows == 1 || rows == parts_.planes.n_planes), "output scaler",
          std::to_string(rows) + " x " + std::to_string(parts_.outputs.mean.cols()),
          "1 or " + std::to_string(parts_.planes.n_planes) + " x " + std::to_string(parts_.n_columns));
  require(parts_.planes.n_planes <= most_encodings / parts_.planes.size(), "plane encoding",
          std::to_string(parts_.planes.n_planes) + " planes x " + std::to_string(parts_.planes.size()) +
              " inputs",
          "at most " + std::to_string(most_encodings) + " values");
  for (const auto& submodel : parts_.submodels) check_submodel(submodel, parts_);
  check_cover(parts_);
  encodings_.resize(static_cast<Eigen::Index>(parts_.planes.n_planes),
                    static_cast<Eigen::Index>(parts_.planes.size()));
  for (std::size_t plane = 0; plane < parts_.planes.n_planes; ++plane)
    parts_.planes.encode(plane,
                         {encodings_.row(static_cast<Eigen::Index>(plane)).data(), parts_.planes.size()});
}

/// One call of predict(), with the boundary conditions scaled.
struct BandedNetworks::Request {
  const Query& query;
  std::span<const float> inputs;
  std::span<float> values, spread;
};

void BandedNetworks::predict(const Query& query, std::span<float> values, std::span<float> spread,
                             Workspace& workspace) const {
  check(values.size() == query.planes.size() * parts_.n_columns, "values are (planes asked for, n_columns)");
  check(spread.empty() || spread.size() == values.size(), "spread is empty or as large as values");
  const Workspace::Frame frame(workspace);
  const std::span<float> inputs = workspace.floats(parts_.inputs.size());
  parts_.inputs.apply(query.inputs, inputs);
  for (const auto& submodel : parts_.submodels)
    predict_submodel(submodel, {query, inputs, values, spread}, workspace);
}

void BandedNetworks::predict_submodel(const Submodel& submodel, const Request& request,
                                      Workspace& workspace) const {
  std::array<std::size_t, block_rows> rows;  // of the query: those in which the submodel answers at all
  std::size_t n_rows = 0;
  const auto flush = [&] {
    if (n_rows > 0) predict_rows(submodel, request, std::span(rows).first(n_rows), workspace);
    n_rows = 0;
  };
  for (std::size_t i = 0; i < request.query.planes.size(); ++i) {
    const auto plane = static_cast<std::size_t>(request.query.planes[i]);
    check(plane < parts_.planes.n_planes, "a plane of the mesh");
    if (!submodel.answers(plane)) continue;
    rows[n_rows++] = i;
    if (n_rows == block_rows) flush();
  }
  flush();
}

/// Outputs of all builds for one plane: build b's output j is data[b * build_stride + j * output_stride].
struct BandedNetworks::RowOutputs {
  const float* data;
  std::size_t n_builds, build_stride, output_stride;
};

void BandedNetworks::predict_rows(const Submodel& submodel, const Request& request,
                                  std::span<const std::size_t> rows, Workspace& workspace) const {
  const bool one = request.query.best_build_only || parts_.combination == Combination::best;
  const std::size_t first = one ? submodel.best() : 0, n_builds = one ? 1 : submodel.builds.size();
  const std::size_t stride = padded(rows.size()), size = submodel.columns.size() * stride;
  const Workspace::Frame frame(workspace);
  const std::span<float> own = workspace.floats(parts_.planes.size() * stride);
  for (std::size_t k = 0; k < parts_.planes.size(); ++k)
    for (std::size_t r = 0; r < stride; ++r) {
      const auto plane = request.query.planes[rows[std::min(r, rows.size() - 1)]];
      own[k * stride + r] = encodings_(plane, static_cast<Eigen::Index>(k));
    }
  const std::span<float> outputs = workspace.floats(n_builds * size);
  for (std::size_t b = 0; b < n_builds; ++b)
    submodel.builds[first + b].forward_shared(request.inputs, own, rows.size(),
                                              outputs.subspan(b * size, size), workspace);
  for (std::size_t r = 0; r < rows.size(); ++r)
    scatter_row(submodel, request, rows[r], {outputs.data() + r, n_builds, size, stride});
}

void BandedNetworks::scatter_row(const Submodel& submodel, const Request& request, std::size_t i_row,
                                 const RowOutputs& outputs) const {
  const auto plane = static_cast<std::size_t>(request.query.planes[i_row]);
  const float* mean = parts_.outputs.mean.row(parts_.outputs.row(plane)).data();
  const float* deviation = parts_.outputs.deviation.row(parts_.outputs.row(plane)).data();
  const auto n = static_cast<float>(outputs.n_builds);
  for (std::size_t j = 0; j < submodel.columns.size(); ++j) {
    if (!submodel.answers(plane, j)) continue;
    const auto column = static_cast<std::size_t>(submodel.columns[j]);
    const auto value = [&](std::size_t b) {
      const float z = outputs.data[b * outputs.build_stride + j * outputs.output_stride];
      return parts_.transform.undo(mean[column] + deviation[column] * z);
    };
    // Sums of differences from the first build: builds lie close together, so nothing cancels.
    const float base = value(0);
    float sum = 0, squares = 0;
    for (std::size_t b = 1; b < outputs.n_builds; ++b) {
      const float difference = value(b) - base;
      sum += difference;
      squares += difference * difference;
    }
    const std::size_t cell = i_row * parts_.n_columns + column;
    request.values[cell] = base + sum / n;
    if (request.spread.empty()) continue;
    request.spread[cell] =
        outputs.n_builds > 1 ? std::sqrt(std::max(0.0F, squares - sum * sum / n) / (n - 1)) : 0.0F;
  }
}

BandedNetworks BandedNetworks::halved() const {
  Parts parts = parts_;
  for (auto& submodel : parts.submodels)
    for (auto& build : submodel.builds) build = build.halved();
  return BandedNetworks(std::move(parts));
}

}  // namespace elrom::model
