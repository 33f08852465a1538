#include "hdf_writer.hpp"

#include <cmath>

#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/io/hdf5.hpp"
#include "physics_writer.hpp"

namespace elrom::fields {
namespace {

/// A field's values: planes x columns, or, of a region, one cell after the other.
io::Shape shape_of(const Run& run) {
  if (run.average || !run.cells.whole_planes) return {run.n_values()};
  return {run.cells.planes.size(), run.cells.n_columns};
}

void write_identity(const Run& run, const field::CaseInputs& inputs, const model::Assessment& assessment,
                    const io::Hdf5Object& object) {
  object.set_text("case", inputs.name);
  object.set_text("bundle_digest", run.bundle_digest);
  object.set_text("validity", model::name_of(assessment.verdict));
}

void write_provenance(const Run& run, const field::CaseInputs& inputs, const model::Assessment& assessment,
                      const io::Hdf5Group& elrom) {
  elrom.set_text("validity_reason", assessment.reason);
  elrom.set_number("validity_distance", assessment.distance);
  elrom.set_number("validity_p_value", assessment.p_value);
  std::vector<std::string> nearest;
  for (const auto& neighbour : assessment.nearest) nearest.push_back(neighbour.name);
  if (!nearest.empty()) elrom.set_texts("nearest_cases", nearest);
  elrom.set_text("mesh_digest", run.mesh_digest);
  elrom.set_text("bundle_program", run.bundle_program);
  elrom.set_text("method", run.method);
  elrom.set_text("builds", run.best_build_only ? "best" : "mean");
  if (run.level) elrom.set_number("interval_level", *run.level);
  if (std::isfinite(inputs.load)) elrom.set_number("load", inputs.load);

  const auto conditions = elrom.write<double>("boundary_conditions", inputs.values);
  std::vector<std::string> units;
  for (const auto& info : run.schema.inputs()) units.push_back(info.unit);
  conditions.set_texts("names", run.schema.names());
  conditions.set_texts("units", units);
}

/// One dataset a field, still without values.
std::vector<io::Hdf5Dataset> create_fields(const Run& run, const io::Hdf5Group& group) {
  std::vector<io::Hdf5Dataset> datasets;
  for (const auto& info : run.fields) {
    datasets.push_back(group.create<float>(info.name, shape_of(run)));
    datasets.back().set_text("unit", info.unit);
  }
  return datasets;
}

void write_mesh(const Run& run, const io::Hdf5Group& elrom) {
  const auto mesh = elrom.create_group("mesh");
  mesh.write<std::int32_t>("planes", run.cells.planes);
  if (run.average) {
    mesh.write<float>("height", run.average->heights()).set_text("unit", "m");
    return;
  }
  auto shape = shape_of(run);
  shape.push_back(3);
  auto centre = run.packed ? mesh.write_packed<float>("centre", shape, run.packed->centre.u8())
                           : mesh.write<float>("centre", run.geometry.centre, shape);
  centre.set_text("unit", "m");
  if (!run.cells.whole_planes) mesh.write<std::int32_t>("cells", run.cells.cells);
}

/// CellData must be one value a cell: links where the datasets are, views without a copy where they are
/// planes x columns.
void show_fields(const Run& run, const io::Hdf5Group& elrom, const std::string& source,
                 const std::string& suffix, const io::Hdf5Group& cell_data) {
  for (const auto& info : run.fields) {
    if (shape_of(run).size() == 1) {
      cell_data.hard_link("/elrom/" + source + "/" + info.name, info.name + suffix);
    } else {
      cell_data.flat_view(elrom.dataset(source + "/" + info.name), info.name + suffix);
    }
  }
}

/// Points and cells as VTK wants them; packed ones are copied as they are.
void write_geometry(const Run& run, const io::Hdf5Group& vtk) {
  constexpr std::size_t n_corners = 8;
  const auto& geometry = run.geometry;
  const std::size_t n_cells = run.cells.size();
  const std::size_t n_points = run.packed ? run.packed->n_points : geometry.points.size() / 3;
  const auto count = [&](const char* name, std::size_t n) {
    const std::int64_t value[] = {static_cast<std::int64_t>(n)};
    vtk.write<std::int64_t>(name, value);
  };
  count("NumberOfPoints", n_points);
  count("NumberOfCells", n_cells);
  count("NumberOfConnectivityIds", n_cells * n_corners);
  if (run.packed) {
    vtk.write_packed<float>("Points", {n_points, 3}, run.packed->points.u8());
    vtk.write_packed<std::int32_t>("Connectivity", {n_cells * n_corners}, run.packed->connectivity.u8());
    vtk.write_packed<std::int32_t>("Offsets", {n_cells + 1}, run.packed->offsets.u8());
    vtk.write_packed<std::uint8_t>("Types", {n_cells}, run.packed->types.u8());
    return;
  }
  vtk.write<float>("Points", geometry.points, {n_points, 3});
  vtk.write<std::int32_t>("Connectivity", geometry.connectivity);
  vtk.write<std::int32_t>("Offsets", geometry.offsets);
  vtk.write<std::uint8_t>("Types", geometry.types);
}

void write_vtk(const Run& run, const io::Hdf5Group& file, const io::Hdf5Group& elrom) {
  const auto vtk = file.create_group("VTKHDF");
  const std::int64_t version[] = {1, 0};
  vtk.set_text("Type", "UnstructuredGrid");
  vtk.set_integers("Version", version);
  write_geometry(run, vtk);
  const auto cell_data = vtk.create_group("CellData");
  show_fields(run, elrom, "fields", "", cell_data);
  if (run.level) show_fields(run, elrom, "half_width", "_half_width", cell_data);
}

}  // namespace

HdfWriter::HdfWriter(const Run& run, const field::CaseInputs& inputs, const model::Assessment& assessment,
                     const std::filesystem::path& path)
    : run_(run), file_(io::Hdf5File::create(path)) {
  io::write_kind(file_, io::kinds::prediction);
  write_identity(run, inputs, assessment, file_);
  const auto elrom = file_.create_group("elrom");
  write_identity(run, inputs, assessment, elrom);
  write_provenance(run, inputs, assessment, elrom);
  values_ = create_fields(run, elrom.create_group(run.average ? "profiles" : "fields"));
  written_.assign(values_.size(), false);
  if (run.level) half_width_ = create_fields(run, elrom.create_group("half_width"));
  write_mesh(run, elrom);
  if (!run.average) write_vtk(run, file_, elrom);
}

void HdfWriter::write_field(const Prediction& prediction, std::size_t i) {
  values_[i].write(prediction.field(prediction.values, run_, i));
  if (!half_width_.empty()) half_width_[i].write(prediction.field(prediction.half_width, run_, i));
  written_[i] = true;
}

void HdfWriter::finish(const Prediction& prediction) {
  for (std::size_t i = 0; i < values_.size(); ++i)
    if (!written_[i]) write_field(prediction, i);
  const auto elrom = file_.group("elrom");
  if (prediction.audit != nullptr) write_audit(*prediction.audit, elrom);
  if (prediction.change != nullptr) write_change(*prediction.change, elrom);
  values_.clear();
  half_width_.clear();
  file_.close();
}

void write_hdf(const Run& run, const Prediction& prediction, const std::filesystem::path& path) {
  HdfWriter(run, *prediction.inputs, *prediction.assessment, path).finish(prediction);
}

}  // namespace elrom::fields
