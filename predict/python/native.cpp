// elrom._native: the core as numpy arrays. Users see the package elrom, which is typed
// and explained; shapes are checked here. Files by the HDF5 library are read and
// written while Python's lock is held: that library takes one thread at a time.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <map>
#include <mutex>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/version.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/fields/formats.hpp"
#include "elrom/fields/physics.hpp"
#include "elrom/fields/ranges.hpp"
#include "elrom/model/prediction_file.hpp"

namespace py = pybind11;

namespace elrom::python {
namespace {

using Path = std::filesystem::path;
using Inputs = py::array_t<double, py::array::c_style | py::array::forcecast>;

template <class T>
py::array_t<T> array(std::span<const T> values, const io::Shape& shape) {
  py::array_t<T> result(std::vector<py::ssize_t>(shape.begin(), shape.end()));
  check(static_cast<std::size_t>(result.size()) == values.size(), "numpy: values of that shape");
  std::copy(values.begin(), values.end(), result.mutable_data());
  return result;
}
template <class T>
py::array_t<T> array(const std::vector<T>& values) {
  return array<T>(std::span<const T>(values), {values.size()});
}

std::vector<double> inputs_of(const Inputs& inputs, const field::InputSchema& schema) {
  if (inputs.ndim() != 1 || static_cast<std::size_t>(inputs.size()) != schema.size()) {
    throw UsageError(
        {.what = "boundary conditions of another shape",
         .found = std::to_string(inputs.ndim()) + " dimensions, " + std::to_string(inputs.size()) + " values",
         .expected = "an array of " + std::to_string(schema.size()) + " values"});
  }
  return {inputs.data(), inputs.data() + inputs.size()};
}

/// None: nothing chosen; a text as on the command line; or numbers.
field::Planes planes_of(const py::object& planes) {
  if (planes.is_none()) return {};
  if (py::isinstance<py::str>(planes)) return fields::parse_planes(planes.cast<std::string>());
  return field::Planes::listed(planes.cast<std::vector<std::int32_t>>());
}

std::optional<model::Box> box_of(const py::object& region) {
  if (region.is_none()) return std::nullopt;
  if (py::isinstance<py::str>(region)) return fields::parse_box(region.cast<std::string>());
  const auto sides = region.cast<std::vector<std::vector<std::optional<double>>>>();
  model::Box box;
  if (sides.size() != box.low.size())
    throw UsageError("a region has three pairs: (x0, x1), (y0, y1), (z0, z1)");
  for (std::size_t axis = 0; axis < sides.size(); ++axis) {
    if (sides[axis].size() != 2)
      throw UsageError("each axis of a region has a pair of sides, None where it is open");
    box.low[axis] = sides[axis][0].value_or(box.low[axis]);
    box.high[axis] = sides[axis][1].value_or(box.high[axis]);
    if (!(box.low[axis] < box.high[axis]))
      throw UsageError("a region's lower side is not below its upper side");
  }
  return box;
}

py::dict dict_of(const model::Assessment& assessment) {
  py::list nearest;
  for (const auto& one : assessment.nearest) nearest.append(py::make_tuple(one.name, one.load, one.distance));
  return py::dict(py::arg("verdict") = std::string(model::name_of(assessment.verdict)),
                  py::arg("reason") = assessment.reason, py::arg("out_of_range") = assessment.out_of_range,
                  py::arg("unusual") = assessment.unusual, py::arg("distance") = assessment.distance,
                  py::arg("p_value") = assessment.p_value, py::arg("nearest") = nearest);
}

py::object change_of(const std::optional<model::ConservationChange>& change) {
  if (!change) return py::none();
  return py::dict(py::arg("solids_kg") = change->solids_kg,
                  py::arg("volume_fraction_rms") = change->volume_fraction_rms,
                  py::arg("volume_fraction_relative") = change->volume_fraction_relative,
                  py::arg("gas_velocity_rms") = change->gas_velocity_rms,
                  py::arg("gas_velocity_relative") = change->gas_velocity_relative,
                  py::arg("n_planes_balanced") = change->n_planes_balanced);
}

class Predictor;

/// One case, with all that its file needs.
struct Predicted {
  std::shared_ptr<const Predictor> owner;
  field::CaseInputs inputs;
  model::Assessment assessment;
  fields::PhysicsResult physics;
  std::vector<float> values, half_width;

  [[nodiscard]] model::Prediction view() const {
    return {.inputs = &inputs,
            .assessment = &assessment,
            .values = values,
            .half_width = half_width,
            .audit = physics.audit ? &*physics.audit : nullptr,
            .change = physics.change ? &*physics.change : nullptr};
  }
};

class Predictor : public std::enable_shared_from_this<Predictor> {
 public:
  Predictor(const Path& bundle, std::vector<std::string> names, const py::object& planes,
            const py::object& region, bool profile, bool best_build_only, std::optional<double> level,
            int n_threads, bool verify)
      : names_(std::move(names)),
        n_threads_(n_threads > 0 ? n_threads : base::available_threads()),
        predictor_(open(bundle, planes, region, profile, best_build_only, level, verify)),
        frame_(predictor_, std::move(*extent_)) {
    extent_.reset();
  }

  [[nodiscard]] const model::Predictor& predictor() const { return predictor_; }
  [[nodiscard]] const model::PredictionFrame& frame() const { return frame_; }
  [[nodiscard]] const field::InputSchema& schema() const { return frame_.schema; }

  [[nodiscard]] io::Shape shape() const {
    const auto& extent = frame_.extent;
    if (!extent.as_predicted()) return {frame_.fields.size(), extent.n_values()};
    return {frame_.fields.size(), extent.cells().planes().size(), extent.cells().n_columns()};
  }

  [[nodiscard]] std::shared_ptr<Predicted> predict(const Inputs& given, const std::string& name, double load,
                                                   bool audit, bool conserve) const {
    auto result = std::make_shared<Predicted>();
    result->owner = shared_from_this();
    result->inputs = {name, load, inputs_of(given, schema())};
    const py::gil_scoped_release free;
    compute(*result, physics(audit, conserve));
    return result;
  }

  [[nodiscard]] fields::Coordinates coordinates() const {
    const auto& extent = frame_.extent;
    if (extent.average()) return fields::coordinates_of(*extent.average());
    if (extent.geometry()) return fields::coordinates_of(*extent.geometry());
    return fields::coordinates_of(predictor_.bundle().mesh({.with_corners = false}));
  }

 private:
  model::Predictor open(const Path& path, const py::object& planes, const py::object& region, bool profile,
                        bool best_build_only, std::optional<double> level, bool verify) {
    model::BundleReader bundle(path, verify ? io::Verify::on_use : io::Verify::never);
    extent_.emplace(bundle,
                    model::Excerpt{.planes = planes_of(planes), .box = box_of(region), .profile = profile},
                    n_threads_);
    model::Selection selection{.fields = names_,
                               .planes = extent_->cells().planes(),
                               .best_build_only = best_build_only,
                               .interval_level = level,
                               .n_threads = n_threads_};
    return model::Predictor(std::move(bundle), std::move(selection));
  }

  void compute(Predicted& result, const fields::Physics* physics) const {
    result.assessment = predictor_.guard().assess(result.inputs.values);
    std::vector<float> values(predictor_.size()), half_width(frame_.level ? values.size() : 0);
    auto scratch = borrow();
    predictor_.predict(result.inputs.values, values, half_width, *scratch, n_threads_);
    give_back(std::move(scratch));
    if (physics != nullptr) result.physics = physics->apply(result.inputs, values);
    const auto keep = [&](std::vector<float>& all, std::vector<float>& kept) {
      if (frame_.extent.as_predicted())
        kept = std::move(all);
      else
        static_cast<void>(frame_.extent.choose(all, frame_.fields.size(), kept));
    };
    keep(values, result.values);
    keep(half_width, result.half_width);
  }

  /// Made when first asked for: it reads the mesh.
  const fields::Physics* physics(bool audit, bool conserve) const {
    if (!audit && !conserve) return nullptr;
    const std::scoped_lock lock(mutex_);
    auto& made = physics_[{audit, conserve}];
    if (!made) {
      fields::Arguments arguments;
      arguments.fields = names_;
      arguments.audit = audit;
      arguments.conserve = conserve;
      made = std::make_unique<fields::Physics>(arguments, predictor_.bundle(), frame_.extent.cells());
    }
    return made.get();
  }

  std::unique_ptr<model::Predictor::Scratch> borrow() const {
    const std::scoped_lock lock(mutex_);
    if (idle_.empty()) return std::make_unique<model::Predictor::Scratch>();
    auto scratch = std::move(idle_.back());
    idle_.pop_back();
    return scratch;
  }
  void give_back(std::unique_ptr<model::Predictor::Scratch> scratch) const {
    const std::scoped_lock lock(mutex_);
    idle_.push_back(std::move(scratch));
  }

  std::vector<std::string> names_;
  int n_threads_;
  std::optional<model::Extent> extent_;  //!< only until the frame has it
  model::Predictor predictor_;
  model::PredictionFrame frame_;
  mutable std::mutex mutex_;  //!< guards the two below
  mutable std::map<std::pair<bool, bool>, std::unique_ptr<fields::Physics>> physics_;
  mutable std::vector<std::unique_ptr<model::Predictor::Scratch>> idle_;
};

void write(const Predicted& predicted, const Path& path, const std::string& format) {
  const auto& frame = predicted.owner->frame();
  const auto& info = fields::format_named(format);
  if (info.format == fields::Format::openfoam)
    throw UsageError(
        "format openfoam starts a case of OpenFOAM; use elrom-predict --format openfoam --onto CASE");
  if (info.write == nullptr) return model::write_prediction(frame, predicted.view(), path);
  if (!info.profiles && frame.extent.average())
    throw UsageError(std::string("format ") + info.name + " holds cells; a profile has none");
  std::string text;
  info.write(frame, predicted.owner->coordinates(), predicted.view(), text);
  base::write_text(path, text);
}

std::vector<py::tuple> inputs_table(const field::InputSchema& schema) {
  std::vector<py::tuple> table;
  for (const auto& info : schema.inputs())
    table.push_back(py::make_tuple(info.name, info.unit, info.display_unit));
  return table;
}
std::vector<py::tuple> fields_table(std::span<const field::FieldInfo> fields) {
  std::vector<py::tuple> table;
  for (const auto& info : fields)
    table.push_back(py::make_tuple(info.name, info.unit, info.meaning, info.lower, info.upper));
  return table;
}
py::tuple tuple_of(const field::CaseInputs& one) {
  return py::make_tuple(one.name, one.load, array(one.values));
}

void bind_predictor(py::module_& module) {
  py::class_<Predicted, std::shared_ptr<Predicted>>(module, "Predicted")
      .def("values", [](const Predicted& self) { return array<float>(self.values, self.owner->shape()); })
      .def("half_width",
           [](const Predicted& self) -> py::object {
             if (self.half_width.empty()) return py::none();
             return array<float>(self.half_width, self.owner->shape());
           })
      .def("inputs", [](const Predicted& self) { return tuple_of(self.inputs); })
      .def("assessment", [](const Predicted& self) { return dict_of(self.assessment); })
      .def("audit_json",
           [](const Predicted& self) {
             return self.physics.audit ? std::optional(model::to_json(*self.physics.audit)) : std::nullopt;
           })
      .def("change", [](const Predicted& self) { return change_of(self.physics.change); })
      .def("physics_text", [](const Predicted& self) { return self.physics.text(); })
      .def("write", &write, py::arg("path"), py::arg("format"));

  py::class_<Predictor, std::shared_ptr<Predictor>>(module, "Predictor")
      .def(py::init<const Path&, std::vector<std::string>, const py::object&, const py::object&, bool, bool,
                    std::optional<double>, int, bool>())
      .def("inputs", [](const Predictor& self) { return inputs_table(self.schema()); })
      .def("fields", [](const Predictor& self) { return fields_table(self.frame().fields); })
      .def("planes", [](const Predictor& self) { return array(self.frame().extent.cells().planes()); })
      .def("cells",
           [](const Predictor& self) {
             const auto& cells = self.frame().extent.cells();
             std::vector<std::int32_t> numbers(cells.size());
             for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = cells.number(i);
             return array(numbers);
           })
      .def("shape", [](const Predictor& self) { return py::tuple(py::cast(self.shape())); })
      .def("coordinates",
           [](const Predictor& self) {
             const auto coordinates = self.coordinates();
             auto shape = self.shape();
             shape.erase(shape.begin());
             if (coordinates.axes.size() > 1) shape.push_back(coordinates.axes.size());
             return array<float>(coordinates.values, shape);
           })
      .def("info",
           [](const Predictor& self) {
             const auto& bundle = self.predictor().bundle();
             return py::dict(
                 py::arg("method") = bundle.info().method, py::arg("digest") = bundle.digest(),
                 py::arg("mesh_digest") = bundle.mesh_digest(),
                 py::arg("program") = bundle.file().text("program"), py::arg("cases") = bundle.info().cases,
                 py::arg("provenance") = bundle.info().provenance,
                 py::arg("accuracy_json") = bundle.info().accuracy_json,
                 py::arg("n_planes") = bundle.n_planes(), py::arg("n_columns") = bundle.n_columns());
           })
      .def("read_cases",
           [](const Predictor& self, const Path& path) {
             py::list cases;
             for (const auto& one : field::read_cases(path, self.schema())) cases.append(tuple_of(one));
             return cases;
           })
      .def("apply_settings",
           [](const Predictor& self, const Inputs& inputs, const std::vector<std::string>& settings) {
             field::CaseInputs one{"case", 0, inputs_of(inputs, self.schema())};
             for (const auto& setting : settings) field::apply_setting(one, setting, self.schema());
             return array(one.values);
           })
      .def("assess",
           [](const Predictor& self, const Inputs& inputs) {
             return dict_of(self.predictor().guard().assess(inputs_of(inputs, self.schema())));
           })
      .def("predict", &Predictor::predict);
}

void bind_files(py::module_& module) {
  py::class_<field::SnapshotStore>(module, "SnapshotStore")
      .def(py::init([](const Path& path) { return field::SnapshotStore::open(path); }))
      .def("cases",
           [](const field::SnapshotStore& self) {
             py::list cases;
             for (const auto& record : self.cases()) cases.append(tuple_of(record.inputs));
             return cases;
           })
      .def("inputs", [](const field::SnapshotStore& self) { return inputs_table(self.schema()); })
      .def("fields", [](const field::SnapshotStore& self) { return fields_table(self.fields()); })
      .def("shape",
           [](const field::SnapshotStore& self) {
             return py::make_tuple(self.n_cases(), self.mesh().n_planes, self.mesh().n_columns);
           })
      .def("find",
           [](const field::SnapshotStore& self, const std::string& pattern) { return self.find(pattern); })
      .def("centres",
           [](const field::SnapshotStore& self) {
             const auto& mesh = self.mesh();
             return array<double>({mesh.centre.data(), static_cast<std::size_t>(mesh.centre.size())},
                                  {mesh.n_planes, mesh.n_columns, 3});
           })
      .def("volumes",
           [](const field::SnapshotStore& self) {
             const auto& mesh = self.mesh();
             return array<double>(mesh.volume, {mesh.n_planes, mesh.n_columns});
           })
      .def("read", [](const field::SnapshotStore& self, const std::string& name,
                      const std::vector<std::size_t>& cases) {
        for (const auto i : cases)
          if (i >= self.n_cases())
            throw UsageError("no case of number " + std::to_string(i) + " in the store");
        const auto values = self.read(name, cases);
        return array<float>({values.data(), static_cast<std::size_t>(values.size())},
                            {cases.size(), self.mesh().n_planes, self.mesh().n_columns});
      });

  module.def("read_prediction", [](const Path& path) {
    const auto stored = model::read_prediction(path);
    py::list fields;
    for (const auto& one : stored.fields) {
      fields.append(py::make_tuple(
          one.name, one.unit, array<float>(one.values, one.shape),
          one.half_width.empty() ? py::object(py::none()) : array<float>(one.half_width, one.shape)));
    }
    return py::dict(
        py::arg("case") = stored.case_name, py::arg("load") = stored.load,
        py::arg("validity") = stored.validity, py::arg("validity_reason") = stored.validity_reason,
        py::arg("nearest_cases") = stored.nearest_cases, py::arg("interval_level") = stored.interval_level,
        py::arg("bundle_digest") = stored.bundle_digest, py::arg("mesh_digest") = stored.mesh_digest,
        py::arg("bundle_program") = stored.bundle_program, py::arg("method") = stored.method,
        py::arg("builds") = stored.builds, py::arg("input_names") = stored.input_names,
        py::arg("input_units") = stored.input_units, py::arg("inputs") = array(stored.inputs),
        py::arg("profiles") = stored.profiles, py::arg("planes") = array(stored.planes),
        py::arg("cells") = array(stored.cells), py::arg("centre") = array(stored.centre),
        py::arg("heights") = array(stored.heights), py::arg("fields") = fields);
  });
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  module.def("version", [] { return std::string(version()); });
  bind_predictor(module);
  bind_files(module);
  // The package has a class for each exit status; it says which by set_error_types.
  static py::object* error_types = nullptr;
  module.def("set_error_types", [](const py::dict& types) { error_types = new py::object(types); });
  py::register_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const Error& error) {
      const py::int_ status(static_cast<int>(error.status()));
      const py::dict types = error_types->cast<py::dict>();
      const auto type =
          types.contains(status) ? types[status].cast<py::object>() : types[py::int_(1)].cast<py::object>();
      PyErr_SetString(type.ptr(), error.what());
    } catch (const std::system_error& error) {  // filesystem errors are among them
      PyErr_SetString(error_types->cast<py::dict>()[py::int_(1)].cast<py::object>().ptr(), error.what());
    }
  });
}

}  // namespace elrom::python
