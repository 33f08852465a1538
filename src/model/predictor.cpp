#include "elrom/model/predictor.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::model {
namespace {

/// Planes are shared out among threads in multiples of this: the
/// models' kernels work on whole vectors of planes.
constexpr std::size_t plane_grain = 16;

/// Bounds of a field in the cells' own precision; a lower bound of a length (diameter) is exclusive.
struct Bounds {
  float low = -std::numeric_limits<float>::max(), high = std::numeric_limits<float>::max();

  explicit Bounds(const field::FieldInfo& info) {
    if (info.lower) low = inside(*info.lower, high, info.unit == "m");
    if (info.upper) high = inside(*info.upper, low, false);
  }

  /// @return false when any value is not finite
  [[nodiscard]] bool enforce(std::span<float> values) const {
    bool finite = true;
    for (float& value : values) {
      finite &= std::abs(value) <= std::numeric_limits<float>::max();
      value = std::min(std::max(value, low), high);
    }
    return finite;
  }

 private:
  static float inside(double bound, float towards, bool exclusive) {
    const auto rounded = static_cast<float>(bound);
    const bool beyond = towards > rounded ? rounded < bound : rounded > bound;
    if (exclusive && bound == 0) return std::numeric_limits<float>::min();
    return beyond || exclusive ? std::nextafter(rounded, towards) : rounded;
  }
};

/// A piece of work: some planes of one field.
struct Unit {
  std::size_t i_field, first_plane, n_planes;
};

/// Whole fields as long as they share out evenly; what is left over is cut into blocks of planes.
std::vector<Unit> units_for(std::size_t n_fields, std::size_t n_planes, std::size_t n_threads) {
  std::vector<Unit> units;
  const std::size_t n_whole = n_fields / n_threads * n_threads;
  const std::size_t share = (n_planes + n_threads - 1) / n_threads;
  const std::size_t block = std::max(plane_grain, share / plane_grain * plane_grain);
  for (std::size_t i = 0; i < n_fields; ++i) {
    std::size_t first = 0;
    while (i >= n_whole && n_planes - first > block + plane_grain) {
      units.push_back({i, first, block});
      first += block;
    }
    units.push_back({i, first, n_planes - first});
  }
  return units;
}

}  // namespace

struct Predictor::Impl {
  BundleReader bundle;
  Selection selection;
  Guard guard;
  std::vector<field::FieldInfo> fields;
  std::vector<std::int32_t> planes;
  std::vector<Bounds> bounds;
  mutable std::vector<std::unique_ptr<FieldModel>> models;
  mutable std::vector<std::unique_ptr<Uncertainty>> uncertainty;
  mutable std::vector<float> quantiles;           //!< of the asked level, (n_fields)
  mutable std::unique_ptr<std::mutex[]> loading;  //!< guards the three above, (n_fields)
  std::vector<Unit> serial_units;

  Impl(BundleReader reader, Selection wanted);
  void load(std::size_t i_field) const;
  void read(std::size_t i_field) const;
  void read_uncertainty(std::size_t i_field, double level) const;
  void compute(const Unit& unit, std::span<const double> inputs, std::span<float> values,
               std::span<float> half_width, Workspace& workspace) const;
};

Predictor::Impl::Impl(BundleReader reader, Selection wanted)
    : bundle(std::move(reader)),
      selection(std::move(wanted)),
      fields(field::keep_fields(bundle.info().fields, selection.fields)),
      planes(selection.planes.numbers(bundle.n_planes())),
      models(fields.size()),
      uncertainty(fields.size()),
      quantiles(fields.size(), 0.0F),
      loading(std::make_unique<std::mutex[]>(fields.size())),
      serial_units(units_for(fields.size(), planes.size(), 1)) {
  guard = bundle.guard();
  for (const auto& info : fields) bounds.emplace_back(info);
  if (selection.load_on_use) return;
  base::parallel_for(fields.size(), selection.n_threads, [&](std::size_t i, int) { load(i); });
}

/// No std::call_once: an error thrown inside would pass the C library's frames, which a program with a static
/// unwinder does not survive.
void Predictor::Impl::load(std::size_t i_field) const {
  const std::scoped_lock lock(loading[i_field]);
  if (!models[i_field]) read(i_field);
}

void Predictor::Impl::read(std::size_t i_field) const {
  const auto& name = fields[i_field].name;
  // The bundle's numbers: what the model's own part of the file says of its planes is not to be believed yet.
  const auto wanted = selection.planes.all() ? field::Planes() : field::Planes(planes);
  auto model = bundle.model(name, {wanted, selection.best_build_only});
  if (selection.interval_level) read_uncertainty(i_field, *selection.interval_level);
  models[i_field] = std::move(model);  // last: it says that all is there
}

void Predictor::Impl::read_uncertainty(std::size_t i_field, double level) const {
  const auto& name = fields[i_field].name;
  uncertainty[i_field] = bundle.uncertainty(name);
  if (!uncertainty[i_field]) {
    throw UsageError({.what = "no prediction intervals for field '" + name + "'",
                      .where = bundle.file().where(),
                      .advice = "train with more cases, or leave out the level"});
  }
  quantiles[i_field] = static_cast<float>(uncertainty[i_field]->quantile(level));
}

void Predictor::Impl::compute(const Unit& unit, std::span<const double> inputs, std::span<float> values,
                              std::span<float> half_width, Workspace& workspace) const {
  const std::size_t n_columns = bundle.n_columns();
  const std::size_t first = (unit.i_field * planes.size() + unit.first_plane) * n_columns;
  const std::size_t n = unit.n_planes * n_columns;
  const auto asked = std::span(planes).subspan(unit.first_plane, unit.n_planes);
  const auto own = values.subspan(first, n);
  load(unit.i_field);
  models[unit.i_field]->predict({inputs, asked, selection.best_build_only}, own, {}, workspace);
  if (!bounds[unit.i_field].enforce(own)) {
    throw NumericalError({.what = "prediction is not finite", .where = "field " + fields[unit.i_field].name});
  }
  if (half_width.empty()) return;
  const auto width = half_width.subspan(first, n);
  uncertainty[unit.i_field]->scale(asked, width);
  const auto factor = static_cast<float>(quantiles[unit.i_field] * uncertainty[unit.i_field]->factor(inputs));
  bool finite = true;
  for (float& value : width) {
    value *= factor;
    finite &= std::abs(value) <= std::numeric_limits<float>::max();
  }
  if (!finite)
    throw NumericalError({.what = "interval is not finite", .where = "field " + fields[unit.i_field].name});
}

Predictor::Predictor(BundleReader bundle, Selection selection)
    : impl_(std::make_unique<Impl>(std::move(bundle), std::move(selection))) {}
Predictor::Predictor(const std::filesystem::path& bundle, Selection selection)
    : Predictor(BundleReader(bundle), std::move(selection)) {}
Predictor::~Predictor() = default;
Predictor::Predictor(Predictor&&) noexcept = default;

const BundleReader& Predictor::bundle() const { return impl_->bundle; }
const Selection& Predictor::selection() const { return impl_->selection; }
const Guard& Predictor::guard() const { return impl_->guard; }
const std::vector<field::FieldInfo>& Predictor::fields() const { return impl_->fields; }
std::span<const std::int32_t> Predictor::planes() const { return impl_->planes; }
std::size_t Predictor::n_columns() const { return impl_->bundle.n_columns(); }

void Predictor::predict(std::span<const double> inputs, std::span<float> values, std::span<float> half_width,
                        Scratch& scratch, int n_threads, const Alongside& alongside) const {
  const std::size_t n_inputs = impl_->bundle.info().schema.size();
  check(inputs.size() == n_inputs, "predictor: one value an input");
  check(values.size() == size(), "predictor: room for the values");
  check(half_width.size() == (impl_->selection.interval_level ? size() : 0),
        "predictor: room for the half-widths");
  for (std::size_t i = 0; i < n_inputs; ++i) {
    if (std::isfinite(inputs[i])) continue;
    throw NumericalError(
        {.what = "not a finite number", .where = "input " + impl_->bundle.info().schema[i].name});
  }
  scratch.held_inputs.resize(n_inputs);
  impl_->guard.hold(inputs, scratch.held_inputs);
  n_threads = std::max(1, n_threads);
  if (scratch.workspaces.size() < static_cast<std::size_t>(n_threads)) {
    scratch.workspaces.resize(static_cast<std::size_t>(n_threads));
  }
  const auto tell = [&](std::size_t i_field) {
    if (alongside.ready) alongside.ready(i_field);
  };
  if (n_threads == 1) {
    if (alongside.first) alongside.first();
    for (const auto& unit : impl_->serial_units) {
      impl_->compute(unit, scratch.held_inputs, values, half_width, scratch.workspaces[0]);
      tell(unit.i_field);
    }
    return;
  }
  const auto units = units_for(fields().size(), planes().size(), static_cast<std::size_t>(n_threads));
  std::vector<std::atomic<int>> left(fields().size());  // units of each field
  for (const auto& unit : units) ++left[unit.i_field];
  const std::size_t n_before = alongside.first ? 1 : 0;
  base::parallel_for(n_before + units.size(), n_threads, [&](std::size_t i, int worker) {
    if (i < n_before) return alongside.first();
    const auto& unit = units[i - n_before];
    impl_->compute(unit, scratch.held_inputs, values, half_width,
                   scratch.workspaces[static_cast<std::size_t>(worker)]);
    if (--left[unit.i_field] == 0) tell(unit.i_field);
  });
}

}  // namespace elrom::model
