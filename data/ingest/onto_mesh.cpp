#include "elrom/ingest/onto_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "conform.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/ingest/resample.hpp"

namespace elrom::ingest {

namespace {

std::string extent_text(const MatrixD& centre) {
  std::vector<std::string> parts;
  for (Eigen::Index d = 0; d < 3; ++d) {
    parts.push_back(base::rounded(centre.col(d).minCoeff(), 3) + " to " +
                    base::rounded(centre.col(d).maxCoeff(), 3));
  }
  return base::join(parts, ", ") + " m";
}

// A mesh in millimetres, or of another furnace, would resample without complaint.
void expect_same_place(const CfdCase& one, const field::Mesh& mesh) {
  constexpr double least_overlap = 0.5, most_size = 1.5;
  for (Eigen::Index d = 0; d < 3; ++d) {
    const double low = mesh.centre.col(d).minCoeff(), high = mesh.centre.col(d).maxCoeff();
    const double from = one.centre.col(d).minCoeff(), to = one.centre.col(d).maxCoeff();
    const double shared = std::min(high, to) - std::max(low, from);
    const double size = high - low;
    if (size <= 0 || to - from <= 0) continue;  // one layer of cells has no extent between centres
    if (shared >= least_overlap * size && to - from <= most_size * size) continue;
    throw InputError({.what = "the case does not lie on the reduced mesh",
                      .where = one.record.source,
                      .found = "cell centres x, y, z at " + extent_text(one.centre),
                      .expected = extent_text(mesh.centre),
                      .advice = "is it another furnace, or not in metres?"});
  }
}

double sum(std::span<const double> volume) {
  return volume.empty() ? std::nan("") : std::reduce(volume.begin(), volume.end());
}

double share(std::size_t part, std::size_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

struct OntoMesh::Impl {
  const field::Mesh& mesh;
  int n_threads;
  std::stop_token stop;
  std::string digest;
  std::optional<Resampler> there, back;
  double source_volume = 0;  //!< of the last mesh; NaN where it is not known

  void use_mesh_of(const CfdCase& one) {
    base::Sha256 hash;
    hash.add(std::as_bytes(std::span(one.centre.data(), static_cast<std::size_t>(one.centre.size()))));
    hash.add(std::as_bytes(std::span(one.volume)));
    const auto new_digest = hash.hex();
    if (new_digest == digest) return;
    expect_same_place(one, mesh);
    there.emplace(one.centre, one.volume, mesh.centre, n_threads, stop);
    back.emplace(mesh.centre, mesh.volume, one.centre, n_threads, stop);
    source_volume = sum(one.volume);
    digest = new_digest;
  }
};

OntoMesh::OntoMesh(const field::Mesh& mesh, int n_threads, const std::stop_token& stop)
    : impl_(new Impl{mesh, n_threads, stop, {}, {}, {}}) {}
OntoMesh::~OntoMesh() = default;

field::Snapshot OntoMesh::bring(const CfdCase& one, const field::InputSchema& schema,
                                const std::vector<field::FieldInfo>& fields) {
  field::Snapshot snapshot{.record = one.record, .fields = {}};
  snapshot.record.inputs.values = conform_inputs(one, schema);
  const auto values = conform_fields(one, fields);
  impl_->use_mesh_of(one);
  snapshot.fields = impl_->there->apply(values);
  snapshot.record.resampling_error = round_trip_error(values, impl_->back->apply(snapshot.fields));
  return snapshot;
}

Coverage OntoMesh::coverage() const {
  check(impl_->there.has_value(), "no case was brought to the mesh");
  return {.uncovered = share(impl_->there->n_far(), impl_->there->n_target()),
          .beyond = share(impl_->back->n_far(), impl_->back->n_target()),
          .volume = impl_->source_volume / sum(impl_->mesh.volume)};
}

std::size_t OntoMesh::n_outside() const { return impl_->there->n_outside(); }

}  // namespace elrom::ingest
