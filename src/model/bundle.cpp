#include "elrom/model/bundle.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "bundle_info.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::model {
BundleReader::BundleReader(const std::filesystem::path& path, io::Verify verify)
    : file_(io::TensorFile::open(path, verify)) {
  io::check_kind(file_, io::kinds::bundle);
  auto description = bundle_description(file_.text("bundle"), file_.where());
  info_ = std::move(description.info);
  n_planes_ = description.n_planes;
  n_columns_ = description.n_columns;
  mesh_digest_ = std::move(description.mesh_digest);
  // A bundle holds a centre for every cell it speaks of: its sizes are bounded by its bytes.
  const auto centre = file_.tensors().find("mesh/centre");
  if (centre == file_.tensors().end() ||
      centre->second.shape() != std::vector{n_planes_ * n_columns_, std::size_t{3}}) {
    throw InputError({.what = "mesh without its cells",
                      .where = file_.where() + ":mesh/centre",
                      .expected = "centres of " + std::to_string(n_planes_ * n_columns_) + " cells"});
  }
}

field::Mesh BundleReader::mesh(const MeshPart& part) const {
  const auto planes = part.planes.numbers(n_planes_);
  field::Mesh mesh;
  mesh.n_planes = planes.size();
  mesh.n_columns = n_columns_;
  const std::size_t n_cells = n_planes_ * n_columns_;
  const std::array<std::size_t, 2> centre_shape{n_cells, 3}, points_shape{io::any_size, 3},
      corners_shape{n_cells, 8};
  std::span<const double> centre, volume;
  std::span<const std::int32_t> corners;
  const std::array<std::function<void()>, 4> readers{
      [&] { corners = file_.tensor("mesh/corners", corners_shape).i32(); },
      [&] { mesh.points = file_.tensor("mesh/points", points_shape).matrix64(); },
      [&] { centre = file_.tensor("mesh/centre", centre_shape).f64(); },
      [&] { volume = file_.tensor("mesh/volume", std::array{n_cells}).f64(); }};
  const std::size_t first = part.with_corners ? 0 : 2;
  base::parallel_for(readers.size() - first, part.n_threads,
                     [&](std::size_t i, int) { readers[first + i](); });
  mesh.centre.resize(static_cast<Eigen::Index>(mesh.n_cells()), 3);
  double* to = mesh.centre.data();
  for (const auto plane : planes) {
    const auto rows = [&](auto values, std::size_t width) {
      return values.subspan(static_cast<std::size_t>(plane) * n_columns_ * width, n_columns_ * width);
    };
    to = std::ranges::copy(rows(centre, 3), to).out;
    std::ranges::copy(rows(volume, 1), std::back_inserter(mesh.volume));
    if (part.with_corners) std::ranges::copy(rows(corners, 8), std::back_inserter(mesh.corners));
  }
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

std::optional<field::Furnace> BundleReader::furnace() const {
  if (!file_.has_text("furnace")) return std::nullopt;
  return field::parse_furnace(file_.text("furnace"), file_.where() + ":furnace");
}

Guard BundleReader::guard() const { return Guard::load(file_, "guard", info_.schema); }

std::unique_ptr<FieldModel> BundleReader::model(const std::string& field, const Wanted& wanted) const {
  const auto prefix = field_prefix(field);
  if (!file_.has_text(prefix)) throw InputError(field::unknown_field(info_.fields, field, file_.where()));
  auto model = load_field_model(file_, prefix, wanted);
  const auto in_words = [](std::size_t inputs, std::size_t planes, std::size_t columns) {
    return std::to_string(inputs) + " inputs, " + std::to_string(planes) + " planes, " +
           std::to_string(columns) + " columns";
  };
  const auto found = in_words(model->n_inputs(), model->n_planes(), model->n_columns());
  const auto expected = in_words(info_.schema.size(), n_planes_, n_columns_);
  if (found != expected) {
    throw InputError({.what = "model of other inputs or another mesh",
                      .where = file_.where() + ":" + prefix,
                      .found = found,
                      .expected = expected});
  }
  return model;
}

std::unique_ptr<Uncertainty> BundleReader::uncertainty(const std::string& field) const {
  const auto prefix = uncertainty_prefix(field);
  if (!file_.has_text(prefix)) return nullptr;
  const std::size_t shape[] = {n_planes_, n_columns_};
  static_cast<void>(file_.tensor(prefix + "/scale", shape));
  auto uncertainty = std::make_unique<Uncertainty>(Uncertainty::load(file_, prefix));
  if (uncertainty->n_inputs() != 0 && uncertainty->n_inputs() != info_.schema.size()) {
    throw InputError({.what = "intervals of other boundary conditions",
                      .where = file_.where() + ":" + prefix,
                      .found = std::to_string(uncertainty->n_inputs()) + " inputs",
                      .expected = std::to_string(info_.schema.size())});
  }
  return uncertainty;
}

}  // namespace elrom::model
