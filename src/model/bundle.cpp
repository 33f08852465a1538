#include "elrom/model/bundle.hpp"

#include <algorithm>
#include <charconv>

#include "bundle_info.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"

namespace elrom::model {
namespace {

int major_of(const std::string& format) {
  int major = -1;
  const auto dot = format.find('.');
  if (dot != std::string::npos) std::from_chars(format.data(), format.data() + dot, major);
  return major;
}

void check_kind(const io::TensorFile& file) {
  const std::string kind = file.has_text("kind") ? file.text("kind") : "none";
  if (kind != bundle_kind) {
    throw InputError({.what = "not a bundle",
                      .where = file.where(),
                      .found = "kind '" + kind + "'",
                      .expected = "'" + std::string(bundle_kind) + "'"});
  }
  const auto& format = file.text("format");
  if (major_of(format) != bundle_format.major) {
    throw InputError({.what = "bundle of another format version",
                      .where = file.where(),
                      .found = format,
                      .expected = std::to_string(bundle_format.major) + ".x",
                      .advice = "use the ELROM that wrote it (" +
                                (file.has_text("program") ? file.text("program") : "unknown") +
                                ") or train again"});
  }
}

/// Names of the tensors under "<prefix>/".
std::vector<std::string> tensors_under(const io::TensorFile& file, const std::string& prefix) {
  std::vector<std::string> names;
  const auto& tensors = file.tensors();
  for (auto item = tensors.lower_bound(prefix + "/"); item != tensors.end(); ++item) {
    if (!item->first.starts_with(prefix + "/")) break;
    names.push_back(item->first);
  }
  return names;
}

void verify_tensors(const io::TensorFile& file, std::vector<std::string> names, int n_threads) {
  // The longest first, so that the threads end together.
  std::stable_sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return file.tensor(a).bytes().size() > file.tensor(b).bytes().size();
  });
  base::parallel_for(names.size(), n_threads, [&](std::size_t i, int) { file.verify(names[i]); });
}

void verify_prefix(const io::TensorFile& file, const std::string& prefix) {
  verify_tensors(file, tensors_under(file, prefix), 1);
}

}  // namespace

BundleReader::BundleReader(const std::filesystem::path& path) : file_(io::TensorFile::open(path)) {
  check_kind(file_);
  auto description = bundle_description(file_.text("bundle"), file_.where());
  info_ = std::move(description.info);
  n_planes_ = description.n_planes;
  n_columns_ = description.n_columns;
  mesh_digest_ = std::move(description.mesh_digest);
}

field::Mesh BundleReader::mesh(bool verify) const {
  if (verify) {
    for (const char* part : {"mesh/centre", "mesh/volume", "mesh/points", "mesh/corners"}) file_.verify(part);
  }
  field::Mesh mesh;
  mesh.n_planes = n_planes_;
  mesh.n_columns = n_columns_;
  const std::size_t n_cells = mesh.n_cells();
  const std::size_t centre_shape[] = {n_cells, 3}, volume_shape[] = {n_cells}, points_shape[] = {0, 3},
                    corners_shape[] = {n_cells, 8};
  mesh.centre = file_.tensor("mesh/centre", centre_shape).matrix64();
  mesh.points = file_.tensor("mesh/points", points_shape).matrix64();
  const auto volume = file_.tensor("mesh/volume", volume_shape).f64();
  const auto corners = file_.tensor("mesh/corners", corners_shape).i32();
  mesh.volume.assign(volume.begin(), volume.end());
  mesh.corners.assign(corners.begin(), corners.end());
  for (const auto corner : mesh.corners) {
    if (corner < 0 || corner >= mesh.points.rows()) {
      throw InputError({.what = "broken mesh",
                        .where = file_.where() + ":mesh/corners",
                        .found = "point " + std::to_string(corner),
                        .expected = "0 to " + std::to_string(mesh.points.rows() - 1)});
    }
  }
  return mesh;
}

void BundleReader::verify(std::span<const field::FieldInfo> fields, bool with_uncertainty,
                          int n_threads) const {
  auto names = tensors_under(file_, "guard");
  for (auto& name : tensors_under(file_, "mesh/packed")) names.push_back(std::move(name));
  for (const auto& info : fields) {
    for (auto& name : tensors_under(file_, field_prefix(info.name))) names.push_back(std::move(name));
    if (!with_uncertainty) continue;
    for (auto& name : tensors_under(file_, uncertainty_prefix(info.name))) names.push_back(std::move(name));
  }
  verify_tensors(file_, std::move(names), n_threads);
}

Guard BundleReader::guard(bool verify) const {
  if (verify) verify_prefix(file_, "guard");
  return Guard::load(file_, "guard", info_.schema);
}

std::unique_ptr<FieldModel> BundleReader::model(const std::string& field, bool verify) const {
  const auto prefix = field_prefix(field);
  if (!file_.has_text(prefix)) {
    std::vector<std::string> names;
    for (const auto& known : info_.fields) names.push_back(known.name);
    throw InputError({.what = "no field '" + field + "'",
                      .where = file_.where(),
                      .advice = base::name_advice(field, names)});
  }
  if (verify) verify_prefix(file_, prefix);
  auto model = load_field_model(file_, prefix);
  if (model->n_columns() != n_columns_) {
    throw InputError({.what = "model of another mesh",
                      .where = file_.where() + ":" + prefix,
                      .found = std::to_string(model->n_columns()) + " columns",
                      .expected = std::to_string(n_columns_)});
  }
  return model;
}

std::unique_ptr<Uncertainty> BundleReader::uncertainty(const std::string& field, bool verify) const {
  const auto prefix = uncertainty_prefix(field);
  if (!file_.has_text(prefix)) return nullptr;
  if (verify) verify_prefix(file_, prefix);
  return std::make_unique<Uncertainty>(Uncertainty::load(file_, prefix));
}

}  // namespace elrom::model
