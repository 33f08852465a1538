#include "opened.hpp"

#include <fstream>

#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/io/hdf5.hpp"
#include "targets.hpp"

namespace elrom::fields {
namespace {

/// The mesh is read only where the extent has it packed, and packed values are no text.
Coordinates coordinates_in(const model::BundleReader& bundle, const model::Extent& extent, int n_threads) {
  if (extent.average()) return coordinates_of(*extent.average());
  if (extent.geometry()) return coordinates_of(*extent.geometry());
  return coordinates_of(bundle.mesh({.with_corners = false, .n_threads = n_threads}));
}

/// @throws UsageError for a name of no field, and for two fields of one name
std::map<std::string, std::string> names_of(const Arguments& arguments, const model::BundleReader& bundle) {
  const auto& known = bundle.info().fields;
  for (const auto& [name, renamed] : arguments.onto.names)
    if (std::ranges::find(known, name, &field::FieldInfo::name) == known.end())
      throw UsageError(field::unknown_field(known, name, "--names"));
  if (arguments.writes(Format::ip))
    expect_fluent_names_differ(field::keep_fields(known, arguments.fields), arguments.onto.names);
  return arguments.onto.names;
}

/// A time folder may be a run's result: none is replaced unasked. Seen before the first case is written.
void expect_free_folders(const Arguments& arguments, const std::vector<field::CaseInputs>& cases) {
  const Targets targets(arguments);
  if (targets.in_case() && cases.size() != 1) {
    throw UsageError({.what = "--output is the OpenFOAM case itself, which one start fits into",
                      .found = std::to_string(cases.size()) + " cases",
                      .advice = "choose one by --case NAME"});
  }
  for (const auto& inputs : cases) {
    const auto folder = targets.path(Format::openfoam, inputs);
    if (arguments.onto.overwrite || !std::filesystem::exists(folder)) continue;
    throw UsageError({.what = "time folder is there already",
                      .where = folder.string(),
                      .advice = "name another by --time, or replace it by --overwrite"});
  }
}

/// What an HDF5 file that was given for a bundle is; empty for another kind of file.
std::string hdf5_kind(const std::filesystem::path& path) {
  constexpr std::string_view signature = "\x89HDF";
  std::string begin(signature.size(), '\0');
  std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  if (begin != signature) return "";
  const auto file = io::Hdf5File::open(path);
  const auto kind = file.has_attribute("kind") ? file.text("kind") : "";
  return kind == io::kinds::snapshots.name    ? "a store of cases"
         : kind == io::kinds::mesh.name       ? "a mesh"
         : kind == io::kinds::prediction.name ? "a prediction"
                                              : "an HDF5 file";
}

model::BundleReader open_bundle(const Arguments& arguments) {
  try {
    return model::BundleReader(arguments.bundle, arguments.verify ? io::Verify::on_use : io::Verify::never);
  } catch (const InputError&) {
    const auto kind = hdf5_kind(arguments.bundle);
    if (kind.empty()) throw;
    const bool store = kind == "a store of cases";
    throw InputError(
        {.what = "--bundle is " + kind + ", not a bundle",
         .where = arguments.bundle.string(),
         .advice = store ? "train one from it with elrom-train run STUDY --store " + arguments.bundle.string()
                         : "give the model.elrom that elrom-train wrote"});
  }
}

}  // namespace

Opened open(const Arguments& arguments, int n_threads, Timing& timing) {
  base::Stopwatch lap;
  auto bundle = open_bundle(arguments);
  auto list = case_list(arguments, bundle.info().schema);
  model::Extent extent(
      bundle, {.planes = arguments.planes, .box = arguments.region, .profile = arguments.profile}, n_threads);
  std::optional<Coordinates> coordinates;
  if (arguments.writes_text()) coordinates = coordinates_in(bundle, extent, n_threads);
  if (coordinates) coordinates->names = names_of(arguments, bundle);
  std::unique_ptr<const Onto> onto;
  if (!arguments.onto.mesh.empty()) onto = std::make_unique<Onto>(arguments, bundle, n_threads);
  if (arguments.writes(Format::openfoam)) expect_free_folders(arguments, list.cases);
  std::optional<Physics> physics;
  if (arguments.audit || arguments.conserve) physics.emplace(arguments, bundle, extent.cells());
  timing.open = lap.lap();
  model::Selection selection{.fields = arguments.fields,
                             .planes = extent.cells().planes(),
                             .best_build_only = arguments.best_build_only,
                             .interval_level = arguments.level,
                             .load_on_use = list.cases.size() == 1 && !arguments.timing,
                             .n_threads = n_threads};
  model::Predictor predictor(std::move(bundle), std::move(selection));
  timing.read = lap.lap();
  model::PredictionFrame frame(predictor, std::move(extent));
  timing.prepare = lap.lap();
  return {std::move(list), std::move(physics),   std::move(coordinates),
          std::move(onto), std::move(predictor), std::move(frame)};
}

}  // namespace elrom::fields
