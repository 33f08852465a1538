#include "elrom/model/prediction_file.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/version.hpp"
#include "elrom/io/vtkhdf.hpp"
#include "prediction_physics.hpp"

namespace elrom::model {
namespace {

/// A field's values: planes x columns, or, of a region, one cell after the other.
io::Shape shape_of(const PredictionFrame& frame) {
  const auto& extent = frame.extent;
  if (!extent.as_predicted()) return {extent.n_values()};
  return {extent.cells().planes().size(), extent.cells().n_columns()};
}

void write_identity(const PredictionFrame& frame, const field::CaseInputs& inputs,
                    const Assessment& assessment, const io::Hdf5Object& object) {
  object.set_text("case", inputs.name);
  object.set_text("bundle_digest", frame.bundle_digest);
  object.set_text("validity", name_of(assessment.verdict));
}

void write_provenance(const PredictionFrame& frame, const field::CaseInputs& inputs,
                      const Assessment& assessment, const io::Hdf5Group& elrom) {
  elrom.set_text("validity_reason", assessment.reason);
  elrom.set_number("validity_distance", assessment.distance);
  elrom.set_number("validity_p_value", assessment.p_value);
  std::vector<std::string> nearest;
  for (const auto& neighbour : assessment.nearest) nearest.push_back(neighbour.name);
  if (!nearest.empty()) elrom.set_texts("nearest_cases", nearest);
  elrom.set_text("mesh_digest", frame.mesh_digest);
  elrom.set_text("bundle_program", frame.bundle_program);
  elrom.set_text("method", frame.method);
  elrom.set_text("builds", frame.best_build_only ? "best" : "mean");
  if (frame.level) elrom.set_number("interval_level", *frame.level);
  if (std::isfinite(inputs.load)) elrom.set_number("load", inputs.load);

  const auto conditions = elrom.write<double>("boundary_conditions", inputs.values);
  std::vector<std::string> units;
  for (const auto& info : frame.schema.inputs()) units.push_back(info.unit);
  conditions.set_texts("names", frame.schema.names());
  conditions.set_texts("units", units);
}

/// One dataset a field, still without values.
std::vector<io::Hdf5Dataset> create_fields(const PredictionFrame& frame, const io::Hdf5Group& group) {
  std::vector<io::Hdf5Dataset> datasets;
  for (const auto& info : frame.fields) {
    datasets.push_back(group.create<float>(info.name, shape_of(frame)));
    datasets.back().set_text("unit", info.unit);
  }
  return datasets;
}

void write_mesh(const PredictionFrame& frame, const io::Hdf5Group& elrom) {
  const auto& extent = frame.extent;
  const auto& cells = extent.cells();
  const auto mesh = elrom.create_group("mesh");
  mesh.write<std::int32_t>("planes", cells.planes());
  if (extent.average()) {
    mesh.write<float>("height", extent.average()->heights()).set_text("unit", "m");
    return;
  }
  auto shape = shape_of(frame);
  shape.push_back(3);
  auto centre = extent.packed() ? mesh.write_packed<float>("centre", shape, extent.packed()->centre.u8())
                                : mesh.write<float>("centre", extent.geometry()->centre, shape);
  centre.set_text("unit", "m");
  if (cells.whole_planes()) return;
  std::vector<std::int32_t> numbers(cells.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = cells.number(i);
  mesh.write<std::int32_t>("cells", numbers);
}

/// The grid; packed, its bytes are copied as they are.
io::Hdf5Group write_grid(const Extent& extent, const io::Hdf5Group& file) {
  if (extent.geometry()) return io::write_vtkhdf(file, extent.geometry()->grid);
  const auto& packed = *extent.packed();
  return io::write_vtkhdf(file, io::PackedVtkHexahedra{.points = packed.points.u8(),
                                                       .connectivity = packed.connectivity.u8(),
                                                       .offsets = packed.offsets.u8(),
                                                       .types = packed.types.u8(),
                                                       .n_points = packed.n_points,
                                                       .n_cells = extent.cells().size()});
}

/// "gas_velocity_x", "gas_velocity_y" and "gas_velocity_z" are shown as "gas_velocity" too.
void show_vectors(const PredictionFrame& frame, const io::Hdf5Group& cell_data, const io::Hdf5Group& fields) {
  for (const auto& info : frame.fields) {
    if (!info.name.ends_with("_x")) continue;
    const auto name = info.name.substr(0, info.name.size() - 2);
    std::vector<io::Hdf5Dataset> components;
    for (const char* axis : {"_x", "_y", "_z"}) {
      if (std::ranges::find(frame.fields, name + axis, &field::FieldInfo::name) != frame.fields.end())
        components.push_back(fields.dataset(name + axis));
    }
    if (components.size() == 3) io::show_cell_vectors(cell_data, components, name);
  }
}

void write_vtk(const PredictionFrame& frame, const io::Hdf5Group& file, const io::Hdf5Group& elrom) {
  const auto cell_data = write_grid(frame.extent, file);
  const auto show = [&](const std::string& source, const std::string& suffix) {
    for (const auto& info : frame.fields) {
      const auto values = source + "/" + info.name;
      io::show_cell_data(cell_data, elrom.dataset(values), "/elrom/" + values, info.name + suffix);
    }
  };
  show("fields", "");
  show_vectors(frame, cell_data, elrom.group("fields"));
  if (frame.level) show("half_width", "_half_width");
}

}  // namespace

PredictionFrame::PredictionFrame(const Predictor& predictor, Extent of)
    : fields(predictor.fields()),
      schema(predictor.bundle().info().schema),
      extent(std::move(of)),
      level(predictor.selection().interval_level),
      bundle_digest(predictor.bundle().digest()),
      mesh_digest(predictor.bundle().mesh_digest()),
      bundle_program(predictor.bundle().file().text("program")),
      method(predictor.bundle().info().method),
      best_build_only(predictor.selection().best_build_only) {
  check(std::ranges::equal(predictor.planes(), extent.cells().planes()),
        "prediction: a predictor of the extent's planes");
}

PredictionWriter::PredictionWriter(const PredictionFrame& frame, const field::CaseInputs& inputs,
                                   const Assessment& assessment, const std::filesystem::path& path)
    : frame_(frame), file_(io::Hdf5File::create(path)) {
  io::write_kind(file_, io::kinds::prediction);
  write_identity(frame, inputs, assessment, file_);
  const auto elrom = file_.create_group("elrom");
  write_identity(frame, inputs, assessment, elrom);
  write_provenance(frame, inputs, assessment, elrom);
  values_ = create_fields(frame, elrom.create_group(frame.extent.average() ? "profiles" : "fields"));
  written_.assign(values_.size(), false);
  if (frame.level) half_width_ = create_fields(frame, elrom.create_group("half_width"));
  write_mesh(frame, elrom);
  if (!frame.extent.average()) write_vtk(frame, file_, elrom);
}

void PredictionWriter::write_field(const Prediction& prediction, std::size_t i) {
  values_[i].write(prediction.field(prediction.values, frame_, i));
  if (!half_width_.empty()) half_width_[i].write(prediction.field(prediction.half_width, frame_, i));
  written_[i] = true;
}

void PredictionWriter::finish(const Prediction& prediction) {
  for (std::size_t i = 0; i < values_.size(); ++i)
    if (!written_[i]) write_field(prediction, i);
  const auto elrom = file_.group("elrom");
  if (prediction.audit != nullptr) write_audit(*prediction.audit, elrom);
  if (prediction.change != nullptr) write_change(*prediction.change, elrom);
  values_.clear();
  half_width_.clear();
  file_.close();
}

void write_prediction(const PredictionFrame& frame, const Prediction& prediction,
                      const std::filesystem::path& path) {
  base::AtomicFile file(path);
  PredictionWriter(frame, *prediction.inputs, *prediction.assessment, file.temporary()).finish(prediction);
  file.commit();
}

}  // namespace elrom::model
