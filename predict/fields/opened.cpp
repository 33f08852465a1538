#include "opened.hpp"

#include "case_list.hpp"

namespace elrom::fields {
namespace {

/// The mesh is read only where the extent has it packed, and packed values are no text.
Coordinates coordinates_in(const model::BundleReader& bundle, const model::Extent& extent, int n_threads) {
  if (extent.average()) return coordinates_of(*extent.average());
  if (extent.geometry()) return coordinates_of(*extent.geometry());
  return coordinates_of(bundle.mesh({.with_corners = false, .n_threads = n_threads}));
}

}  // namespace

Opened open(const Arguments& arguments, int n_threads, Timing& timing) {
  Stopwatch lap;
  model::BundleReader bundle(arguments.bundle, arguments.verify ? io::Verify::on_use : io::Verify::never);
  auto cases = case_list(arguments, bundle.info().schema);
  model::Extent extent(
      bundle, {.planes = arguments.planes, .box = arguments.region, .profile = arguments.profile}, n_threads);
  std::optional<Coordinates> coordinates;
  if (arguments.writes_text()) coordinates = coordinates_in(bundle, extent, n_threads);
  std::optional<Physics> physics;
  if (arguments.audit || arguments.conserve) physics.emplace(arguments, bundle, extent.cells());
  timing.open = lap.lap();
  model::Selection selection{.fields = arguments.fields,
                             .planes = extent.cells().planes(),
                             .best_build_only = arguments.best_build_only,
                             .interval_level = arguments.level,
                             .load_on_use = cases.size() == 1 && !arguments.timing,
                             .n_threads = n_threads};
  model::Predictor predictor(std::move(bundle), std::move(selection));
  timing.read = lap.lap();
  model::PredictionFrame frame(predictor, std::move(extent));
  timing.prepare = lap.lap();
  return {std::move(cases), std::move(physics), std::move(coordinates), std::move(predictor),
          std::move(frame)};
}

}  // namespace elrom::fields
