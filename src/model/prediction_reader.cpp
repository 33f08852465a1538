#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/model/prediction_file.hpp"

namespace elrom::model {
namespace {

std::optional<double> number_of(const io::Hdf5Object& object, const std::string& name) {
  if (!object.has_attribute(name)) return std::nullopt;
  const auto values = object.numbers(name);
  if (values.empty())
    throw InputError({.what = "attribute " + name + " holds no value", .where = object.where()});
  return values[0];
}

void read_identity(const io::Hdf5Group& elrom, StoredPrediction& stored) {
  stored.case_name = elrom.text("case");
  stored.validity = elrom.text("validity");
  stored.validity_reason = elrom.text("validity_reason");
  stored.bundle_digest = elrom.text("bundle_digest");
  stored.mesh_digest = elrom.text("mesh_digest");
  stored.bundle_program = elrom.text("bundle_program");
  stored.method = elrom.text("method");
  stored.builds = elrom.text("builds");
  if (elrom.has_attribute("nearest_cases")) stored.nearest_cases = elrom.texts("nearest_cases");
  stored.load = number_of(elrom, "load");
  stored.interval_level = number_of(elrom, "interval_level");
}

void read_inputs(const io::Hdf5Group& elrom, StoredPrediction& stored) {
  const auto dataset = elrom.dataset("boundary_conditions");
  stored.inputs = dataset.read<double>();
  stored.input_names = dataset.texts("names");
  stored.input_units = dataset.texts("units");
  if (stored.input_names.size() != stored.inputs.size() ||
      stored.input_units.size() != stored.inputs.size()) {
    throw InputError({.what = "names and units do not fit the values", .where = dataset.where()});
  }
}

void read_mesh(const io::Hdf5Group& mesh, StoredPrediction& stored) {
  stored.planes = mesh.dataset("planes").read<std::int32_t>();
  if (mesh.has("cells")) stored.cells = mesh.dataset("cells").read<std::int32_t>();
  if (mesh.has("centre")) stored.centre = mesh.dataset("centre").read<float>();
  if (mesh.has("height")) stored.heights = mesh.dataset("height").read<float>();
}

void read_fields(const io::Hdf5Group& elrom, StoredPrediction& stored) {
  stored.profiles = !elrom.has("fields");
  const auto fields = elrom.group(stored.profiles ? "profiles" : "fields");
  for (const auto& name : fields.names()) {
    const auto dataset = fields.dataset(name);
    StoredPrediction::Field field{.name = name,
                                  .unit = dataset.text("unit"),
                                  .shape = dataset.shape(),
                                  .values = dataset.read<float>(),
                                  .half_width = {}};
    if (stored.interval_level) {
      const auto half_width = elrom.dataset("half_width/" + name);
      half_width.expect_shape(field.shape);
      field.half_width = half_width.read<float>();
    }
    stored.fields.push_back(std::move(field));
  }
}

StoredPrediction read_here(const std::filesystem::path& path) {
  const auto file = io::Hdf5File::open(path);
  io::check_kind(file, io::kinds::prediction);
  const auto elrom = file.group("elrom");
  StoredPrediction stored;
  read_identity(elrom, stored);
  read_inputs(elrom, stored);
  read_mesh(elrom.group("mesh"), stored);
  read_fields(elrom, stored);
  return stored;
}

}  // namespace

const StoredPrediction::Field& StoredPrediction::field(const std::string& name) const {
  std::vector<std::string> names;
  for (const auto& item : fields) {
    if (item.name == name) return item;
    names.push_back(item.name);
  }
  throw UsageError(
      {.what = "no field '" + name + "' in the prediction", .advice = base::name_advice(name, names)});
}

StoredPrediction read_prediction(const std::filesystem::path& path) {
  io::survive(path, "prediction", [&] { static_cast<void>(read_here(path)); });
  return read_here(path);
}

}  // namespace elrom::model
