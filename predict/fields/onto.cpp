#include "onto.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::fields {
namespace {

namespace fs = std::filesystem;

constexpr const char* fraction = "solid_volume_fraction";

/// Column of the first heading that is one of `names`; nothing: none.
std::optional<std::size_t> column_of(const io::CsvTable& table, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < table.headings.size(); ++i)
    if (std::ranges::find(names, base::split_unit(table.headings[i]).name) != names.end()) return i;
  return std::nullopt;
}

/// In SI, by the unit in the heading, or in the cell, which wins. @param si unit of what has none
std::vector<double> values_of(const io::CsvTable& table, std::size_t column, const std::string& si) {
  const auto symbol = base::split_unit(table.headings[column]).symbol;
  std::vector<double> values;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    auto given = table.quantity(row, column);
    if (given.symbol.empty()) given.symbol = symbol.empty() ? si : symbol;
    try {
      values.push_back(base::to_si(given, si));
    } catch (const InputError& error) {
      throw InputError({.what = error.what(), .where = table.place(row, column)});
    }
  }
  return values;
}

Places read_table(const fs::path& file) {
  const auto table = io::read_csv(file);
  Places places;
  places.centre.resize(static_cast<Eigen::Index>(table.rows.size()), 3);
  for (int d = 0; d < 3; ++d) {
    const std::string axis(1, "xyz"[d]);
    const auto column = column_of(table, {axis, axis + "-coordinate"});
    if (!column) {
      throw InputError(
          {.what = "no column '" + axis + "'",
           .where = file.string(),
           .found = base::join(table.headings, ", "),
           .expected = "x, y, z (or x-coordinate, ...) in m, or x [mm], ...: a cell's centre a line"});
    }
    const auto values = values_of(table, *column, "m");
    for (std::size_t i = 0; i < values.size(); ++i)
      places.centre(static_cast<Eigen::Index>(i), d) = values[i];
  }
  if (const auto column = column_of(table, {"volume", "cell-volume"}))
    places.volume = values_of(table, *column, "m3");
  return places;
}

Places read_hdf5(const fs::path& file) {
  Places places;
  const auto read = [&] {
    const auto hdf5 = io::Hdf5File::open(file);
    const auto centre = hdf5.dataset("mesh/centre");
    centre.expect_shape({0, 3});
    const auto values = centre.read<double>();
    places.centre = Eigen::Map<const MatrixD>(values.data(), static_cast<Eigen::Index>(values.size() / 3), 3);
    if (!hdf5.has("mesh/volume")) return;
    const auto volume = hdf5.dataset("mesh/volume");
    volume.expect_shape({values.size() / 3});
    places.volume = volume.read<double>();
  };
  io::survive(file, "cell centres", read);
  read();
  if (!places.centre.allFinite())
    throw InputError({.what = "cell centres that are not finite", .where = file.string()});
  return places;
}

Places read_places(const fs::path& file) {
  if (!fs::exists(file)) throw InputError({.what = "no such file", .where = file.string()});
  auto places = file.extension() == ".csv" ? read_table(file) : read_hdf5(file);
  if (places.centre.rows() == 0) throw InputError({.what = "no cell centres", .where = file.string()});
  return places;
}

std::string extent_text(const MatrixD& points) {
  std::vector<std::string> sides;
  for (Eigen::Index d = 0; d < 3; ++d)
    sides.push_back(base::rounded(points.col(d).minCoeff()) + " to " +
                    base::rounded(points.col(d).maxCoeff()));
  return base::join(sides, ", ") + " m";
}

/// A mesh in millimetres, or of another furnace, would get a nearest cell's value everywhere.
void expect_overlap(const Interpolator& interpolator, const Places& places, const field::Mesh& from,
                    const fs::path& file) {
  if (interpolator.n_outside() < interpolator.n_target()) return;
  throw InputError(
      {.what = "no cell lies in the reduced mesh",
       .where = file.string(),
       .found = "centres x, y, z at " + extent_text(places.centre),
       .expected = extent_text(from.points),
       .advice = "is it another furnace, or not in m? A table's headings may give a unit: x [mm]"});
}

/// Which phase a field is of: its mean is to be weighted by that phase's share.
enum class Phase { none, gas, solids };
Phase phase_of(const std::string& field) {
  if (field.starts_with("gas_velocity")) return Phase::gas;
  return field.starts_with("solid_velocity") || field == "solid_diameter" ? Phase::solids : Phase::none;
}

std::optional<std::size_t> index_of(const model::PredictionFrame& frame, const std::string& name) {
  const auto found = std::ranges::find(frame.fields, name, &field::FieldInfo::name);
  if (found == frame.fields.end()) return std::nullopt;
  return static_cast<std::size_t>(found - frame.fields.begin());
}

/// Rounded as it is printed, so that nothing prints as -0.000.
double thousandths(double value) { return std::round(1e3 * value) / 1e3 + 0.0; }

double sum_of(std::span<const float> values, std::span<const double> volumes) {
  return std::transform_reduce(
      values.begin(), values.end(), volumes.begin(), 0.0, std::plus<>(),
      [](float value, double volume) { return static_cast<double>(value) * volume; });
}

void expect_standard_fields(const model::BundleReader& bundle) {
  for (const auto& info : field::standard_fields()) {
    if (std::ranges::find(bundle.info().fields, info.name, &field::FieldInfo::name) !=
        bundle.info().fields.end())
      continue;
    throw UsageError({.what = "--format openfoam needs field '" + info.name + "'",
                      .advice = "the bundle has no such field"});
  }
}

}  // namespace

Onto::Onto(const Arguments& arguments, const model::BundleReader& bundle, int n_threads)
    : options_(arguments.onto) {
  if (fs::is_directory(options_.mesh)) {
    read_case(arguments, bundle);
  } else {
    places_ = read_places(options_.mesh);
  }
  const MatrixF centre = places_.centre.cast<float>();
  coordinates_ = {{"x", "y", "z"}, {centre.data(), centre.data() + centre.size()}, options_.names};
  const auto from = bundle.mesh({.n_threads = n_threads});
  source_volume_ = from.volume;
  interpolator_ = std::make_unique<Interpolator>(from, places_, options_.interpolation, n_threads);
  expect_overlap(*interpolator_, places_, from, options_.mesh);
}

void Onto::read_case(const Arguments& arguments, const model::BundleReader& bundle) {
  const auto poly_mesh = options_.mesh / "constant" / "polyMesh";
  if (arguments.writes(Format::openfoam)) {
    expect_standard_fields(bundle);
    case_ = foam::read_foam_case(options_.mesh);
    const auto furnace = bundle.furnace();
    solid_density_ = case_->solid_density.value_or(furnace ? furnace->solid_density : 0);
    if (!case_->cloud.empty() && !(solid_density_ > 0)) {
      throw InputError({.what = "density of the solids is not known",
                        .where = (options_.mesh / "constant" / (case_->cloud + "Properties")).string(),
                        .expected = "rho0"});
    }
  }
  mesh_ = std::make_unique<foam::FoamMesh>(foam::read_poly_mesh(poly_mesh));
  cells_ = std::make_unique<foam::FoamCells>(*mesh_);
  places_ = {mesh_->centre, mesh_->volume, [this](std::size_t cell, const Eigen::Vector3d& point) {
               return cells_->contains(cell, point);
             }};
}

std::string Onto::lines(double before, double after, std::optional<double> factor) const {
  std::string text;
  if (!places_.volume.empty() && before > 0) {
    const bool mass = solid_density_ > 0;
    text += fmt::format("\n  onto {}: solids {} {} predicted, {} there ({:+.3f} %{})", options_.mesh.string(),
                        base::rounded(before * (mass ? solid_density_ : 1), 6), mass ? "kg" : "m3",
                        base::rounded(after * (mass ? solid_density_ : 1), 6),
                        thousandths(100 * (after / before - 1)),
                        factor ? fmt::format("; scaled by {:.5f}", *factor) : "");
  }
  if (const auto n = interpolator_->n_outside(); n > 0) {
    text +=
        fmt::format("\n  {} of {} cells lie outside the reduced mesh: they take the nearest cell's values", n,
                    interpolator_->n_target());
  }
  return text;
}

Onto::Placed Onto::place(const model::PredictionFrame& frame, const model::Prediction& prediction) const {
  const auto n = interpolator_->n_target();
  Placed placed{std::vector<float>(frame.fields.size() * n), {}};
  const auto i_fraction = index_of(frame, fraction);
  std::vector<float> solids, gas;
  if (i_fraction && options_.interpolation == Interpolation::conservative) {
    for (const float value : prediction.field(prediction.values, frame, *i_fraction)) {
      solids.push_back(std::max(0.0F, value));
      gas.push_back(1 - value);
    }
  }
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    const auto phase = phase_of(frame.fields[i].name);
    const std::span<const float> importance = phase == Phase::gas      ? std::span<const float>(gas)
                                              : phase == Phase::solids ? std::span<const float>(solids)
                                                                       : std::span<const float>();
    interpolator_->apply(prediction.field(prediction.values, frame, i), importance,
                         std::span(placed.values).subspan(i * n, n));
  }
  if (!i_fraction) {
    placed.text = lines(0, 0);
    return placed;
  }
  const auto predicted = prediction.field(prediction.values, frame, *i_fraction);
  const auto there = std::span(placed.values).subspan(*i_fraction * n, n);
  std::optional<double> factor;
  if (options_.interpolation == Interpolation::conservative && !places_.volume.empty()) {
    const double now = sum_of(there, places_.volume);
    factor = now > 0 ? interpolator_->integral(predicted) / now : 1;
    for (auto& value : there) value = static_cast<float>(value * *factor);
  }
  placed.text = lines(sum_of(predicted, source_volume_),
                      places_.volume.empty() ? 0 : sum_of(there, places_.volume), factor);
  return placed;
}

std::string Onto::write_time_folder(const model::PredictionFrame& frame, const model::Prediction& prediction,
                                    const fs::path& folder) const {
  auto placed = place(frame, prediction);
  const auto n = interpolator_->n_target();
  const auto values = [&](const std::string& name) {
    return std::span<const float>(placed.values).subspan(*index_of(frame, name) * n, n);
  };
  const foam::StartFields start{values("gas_velocity_x"),
                                values("gas_velocity_y"),
                                values("gas_velocity_z"),
                                values("pressure"),
                                {values(fraction), values("solid_diameter"), values("solid_velocity_x"),
                                 values("solid_velocity_y"), values("solid_velocity_z")}};
  std::vector<foam::Parcel> parcels;
  if (!case_->cloud.empty()) {
    constexpr std::size_t usual = 10000;
    const foam::CloudSettings settings{.n_parcels = options_.n_parcels.value_or(
                                           case_->n_parcels.value_or(0) > 0 ? *case_->n_parcels : usual),
                                       .density = solid_density_,
                                       .spread = options_.parcel_spread};
    parcels = foam::draw_cloud(*mesh_, start.solids, settings, base::Seed(1).derive(prediction.inputs->name));
    placed.text += fmt::format("\n  {} parcels in cloud {}, of {} kg each", parcels.size(), case_->cloud,
                               base::rounded(sum_of(values(fraction), places_.volume) * solid_density_ /
                                             static_cast<double>(std::max<std::size_t>(1, parcels.size()))));
  }
  fs::create_directories(folder.parent_path());
  foam::write_time_folder(*case_, folder, start, parcels, solid_density_,
                          fmt::format("ELROM prediction of {}, {}, bundle {}", prediction.inputs->name,
                                      model::name_of(prediction.assessment->verdict), frame.bundle_digest));
  return std::move(placed.text);
}

}  // namespace elrom::fields
