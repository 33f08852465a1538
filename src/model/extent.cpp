#include "elrom/model/extent.hpp"

#include <algorithm>

namespace elrom::model {
namespace {

/// Bundles of format 1.0 lack it.
std::optional<PackedGeometry> packed_geometry(const BundleReader& bundle) {
  const auto& file = bundle.file();
  if (!file.has("mesh/packed/points")) return std::nullopt;
  const auto part = [&](const char* name) { return file.tensor(std::string("mesh/packed/") + name); };
  return PackedGeometry{.centre = part("centre"),
                        .points = part("points"),
                        .connectivity = part("connectivity"),
                        .offsets = part("offsets"),
                        .types = part("types"),
                        .n_points = file.tensors().at("mesh/points").shape().at(0)};
}

}  // namespace

Extent::Parts Extent::read(const BundleReader& bundle, const Excerpt& excerpt, int n_threads) {
  if (excerpt.everything()) {
    if (auto packed = packed_geometry(bundle))
      return {Cells(bundle.n_planes(), bundle.n_columns()), *std::move(packed)};
  }
  return take(bundle.mesh({excerpt.planes, !excerpt.profile, n_threads}), bundle.n_planes(), excerpt);
}

Extent::Parts Extent::take(const field::Mesh& mesh, std::size_t n_planes, const Excerpt& excerpt) {
  Cells cells(mesh, n_planes, excerpt.planes, excerpt.box);
  if (excerpt.profile) return {cells, PlaneAverage(mesh, cells)};
  return {cells, geometry_of(mesh, cells)};
}

Extent::Extent(const BundleReader& bundle, const Excerpt& excerpt, int n_threads)
    : Extent(read(bundle, excerpt, n_threads)) {}
Extent::Extent(const field::Mesh& mesh, std::size_t n_planes, const Excerpt& excerpt)
    : Extent(take(mesh, n_planes, excerpt)) {}

std::span<const float> Extent::choose(std::span<const float> predicted, std::size_t n_fields,
                                      std::vector<float>& buffer) const {
  if (predicted.empty() || as_predicted()) return predicted;
  const std::size_t n = n_values(), n_predicted = cells_.planes().size() * cells_.n_columns();
  check(predicted.size() == n_fields * n_predicted, "extent: a prediction of its planes");
  buffer.resize(n_fields * n);
  std::vector<float> gathered(cells_.size());
  for (std::size_t f = 0; f < n_fields; ++f) {
    const auto field = predicted.subspan(f * n_predicted, n_predicted);
    for (std::size_t i = 0; i < gathered.size(); ++i) gathered[i] = field[cells_.place(i)];
    const auto out = std::span(buffer).subspan(f * n, n);
    if (average()) {
      average()->apply(gathered, out);
    } else {
      std::ranges::copy(gathered, out.begin());
    }
  }
  return buffer;
}

}  // namespace elrom::model
