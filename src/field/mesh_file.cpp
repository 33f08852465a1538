// Meshes in files: of their own (kind "elrom-mesh") and as a group of other files.
#include <algorithm>
#include <cmath>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::field {

namespace {

std::size_t size_attribute(const io::Hdf5Group& group, const std::string& name) {
  const double value = group.number(name);
  constexpr double most = 1e9;
  if (!(value >= 1 && value <= most) || value != std::floor(value)) {
    throw InputError({.what = "attribute '" + name + "'",
                      .where = group.where(),
                      .found = base::number(value),
                      .expected = "a whole number, 1 or more"});
  }
  return static_cast<std::size_t>(value);
}

MatrixD read_table(const io::Hdf5Dataset& dataset) {
  const auto shape = dataset.shape();
  const auto values = dataset.read<double>();
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    throw InputError({.what = "a coordinate that is not finite", .where = dataset.where()});
  }
  return Eigen::Map<const MatrixD>(values.data(), static_cast<Eigen::Index>(shape[0]),
                                   static_cast<Eigen::Index>(shape[1]));
}

template <class T>
void write_packed(const io::Hdf5Group& group, const std::string& name, std::span<const T> values,
                  const io::Shape& shape, std::string_view unit) {
  constexpr int level = 9;  // small, written once
  const auto dataset = group.write<T>(name, values, shape, io::Hdf5Storage::packed(shape, level));
  dataset.set_text("unit", unit);
}

std::span<const double> values_of(const MatrixD& table) {
  return {table.data(), static_cast<std::size_t>(table.size())};
}

}  // namespace

Mesh read_mesh(const io::Hdf5Group& group) {
  Mesh mesh;
  mesh.n_planes = size_attribute(group, "n_planes");
  mesh.n_columns = size_attribute(group, "n_columns");
  const auto centre = group.dataset("centre"), volume = group.dataset("volume");
  centre.expect_shape({mesh.n_cells(), 3});
  volume.expect_shape({mesh.n_cells()});
  mesh.centre = read_table(centre);
  mesh.volume = volume.read<double>();
  if (!std::all_of(mesh.volume.begin(), mesh.volume.end(),
                   [](double v) { return v > 0 && std::isfinite(v); })) {
    throw InputError({.what = "a cell without volume", .where = volume.where()});
  }
  const auto points = group.dataset("points"), corners = group.dataset("corners");
  points.expect_shape({0, 3});
  corners.expect_shape({mesh.n_cells(), 8});
  mesh.points = read_table(points);
  mesh.corners = corners.read<std::int32_t>();
  const auto n_points = mesh.points.rows();
  if (!std::all_of(mesh.corners.begin(), mesh.corners.end(),
                   [&](std::int32_t c) { return c >= 0 && c < n_points; })) {
    throw InputError({.what = "a corner that is no point", .where = corners.where()});
  }
  return mesh;
}

void write_mesh(const io::Hdf5Group& group, const Mesh& mesh) {
  group.set_integer("n_planes", static_cast<std::int64_t>(mesh.n_planes));
  group.set_integer("n_columns", static_cast<std::int64_t>(mesh.n_columns));
  group.set_text("digest", mesh.digest());
  write_packed<double>(group, "centre", values_of(mesh.centre), {mesh.n_cells(), 3}, "m");
  write_packed<double>(group, "volume", mesh.volume, {mesh.n_cells()}, "m3");
  write_packed<double>(group, "points", values_of(mesh.points),
                       {static_cast<std::size_t>(mesh.points.rows()), 3}, "m");
  write_packed<std::int32_t>(group, "corners", mesh.corners, {mesh.n_cells(), 8}, "1");
}

Mesh read_mesh(const std::filesystem::path& path) {
  const auto read = [&] {
    const auto file = io::Hdf5File::open(path);
    io::check_kind(file, io::kinds::mesh);
    return read_mesh(file.group("mesh"));
  };
  io::survive(path, "mesh", [&] { static_cast<void>(read()); });
  return read();
}

void write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
  base::AtomicFile target(path);
  auto file = io::Hdf5File::create(target.temporary());
  io::write_kind(file, io::kinds::mesh);
  write_mesh(file.create_group("mesh"), mesh);
  file.close();
  target.commit();
}

}  // namespace elrom::field
