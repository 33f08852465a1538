// Apart from reading (bundle.cpp): packing the mesh needs HDF5, which nothing that only predicts should link.
#include "bundle_info.hpp"
#include "elrom/base/error.hpp"
#include "elrom/model/bundle.hpp"
#include "packed_mesh.hpp"

namespace elrom::model {
namespace {

void save_mesh(io::TensorFile& file, const field::Mesh& mesh) {
  file.set("mesh/centre", io::Tensor::copy(mesh.centre));
  file.set("mesh/volume", io::Tensor::copy(std::span(mesh.volume), {mesh.volume.size()}));
  file.set("mesh/points", io::Tensor::copy(mesh.points));
  file.set("mesh/corners", io::Tensor::copy(std::span(mesh.corners), {mesh.corners.size() / 8, 8}));
}

/// Names and shapes of a bundle under construction agree with each other.
void check_consistent(const Bundle& bundle) {
  for (const auto& info : bundle.info.fields) {
    const auto model = bundle.models.find(info.name);
    check(model != bundle.models.end() && model->second != nullptr, "bundle: a model for every field");
    check(model->second->n_columns() == bundle.mesh.n_columns, "bundle: models on the bundle's mesh");
  }
  check(bundle.models.size() == bundle.info.fields.size(), "bundle: a field for every model");
}

}  // namespace

void Bundle::write(const std::filesystem::path& path) const {
  check_consistent(*this);
  io::TensorFile file;
  io::write_kind(file, io::kinds::bundle);
  file.set_text("bundle", to_json({info, mesh.n_planes, mesh.n_columns, mesh.digest()}));
  if (furnace) file.set_text("furnace", field::to_toml(*furnace));
  save_mesh(file, mesh);
  save_packed_mesh(file, mesh);
  guard.save(file, "guard");
  for (const auto& [name, model] : models) model->save(file, field_prefix(name));
  for (const auto& [name, interval] : uncertainty) {
    if (interval) interval->save(file, uncertainty_prefix(name));
  }
  file.write(path);
}

}  // namespace elrom::model
