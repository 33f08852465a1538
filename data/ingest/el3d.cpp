// EL3D exports: one HDF5 file a case (data/FORMATS.md, "EL3D export").

#include "el3d.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/field/catalogue.hpp"

namespace elrom::ingest {
namespace {

base::Unit unit_of(const io::Hdf5Object& object, const std::string& symbol, const std::string& si) {
  try {
    const auto& unit = base::unit(symbol);
    if (unit.si == si) return unit;
  } catch (const InputError&) {
    // The message below says more: where, and what fits.
  }
  throw InputError({.what = "wrong unit",
                    .where = object.where(),
                    .found = "'" + symbol + "'",
                    .expected = "one of " + base::join(base::units_of(si), ", ")});
}

void read_field(const io::Hdf5Dataset& dataset, const base::Unit& unit, std::span<float> row) {
  dataset.expect_shape({row.size()});
  std::vector<double> values(row.size());
  dataset.read_into<double>(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    row[i] = static_cast<float>(unit.to_si(values[i]));
    if (std::isfinite(row[i])) continue;
    throw InputError({.what = "a value that is not finite",
                      .where = dataset.where() + ", cell " + std::to_string(i),
                      .found = base::number(values[i])});
  }
}

// The standard fields in their order first, then whatever else the file holds, by name.
std::vector<std::string> field_order(const io::Hdf5Group& group) {
  std::vector<std::string> order;
  const auto names = group.names();
  for (const auto& field : field::standard_fields()) {
    if (std::find(names.begin(), names.end(), field.name) != names.end()) order.push_back(field.name);
  }
  for (const auto& name : names) {
    if (std::find(order.begin(), order.end(), name) == order.end()) order.push_back(name);
  }
  return order;
}

void read_fields(const io::Hdf5File& file, CfdCase& one) {
  const auto group = file.group("fields");
  const auto names = field_order(group);
  one.values.resize(static_cast<Eigen::Index>(names.size()), one.centre.rows());
  for (const auto& name : names) {
    const auto dataset = group.dataset(name);
    const auto symbol = dataset.text("unit");
    const auto known = field::field_info(name, "");
    const auto unit = known.unit.empty() ? base::unit(symbol) : unit_of(dataset, symbol, known.unit);
    const auto row = static_cast<Eigen::Index>(one.fields.size());
    one.fields.push_back(field::field_info(name, unit.si));
    read_field(dataset, unit, {one.values.row(row).data(), static_cast<std::size_t>(one.centre.rows())});
  }
}

void read_boundary_conditions(const io::Hdf5File& file, CfdCase& one) {
  const auto dataset = file.dataset("boundary_conditions");
  const auto names = dataset.texts("names"), symbols = dataset.texts("units");
  dataset.expect_shape({names.size()});
  if (symbols.size() != names.size()) {
    throw InputError({.what = "names and units differ in number",
                      .where = dataset.where(),
                      .found = std::to_string(symbols.size()) + " units",
                      .expected = std::to_string(names.size())});
  }
  const auto values = dataset.read<double>();
  std::vector<field::InputInfo> inputs;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto place = dataset.where() + ", '" + names[i] + "'";
    if (names[i].empty() || std::count(names.begin(), names.end(), names[i]) != 1) {
      throw InputError({.what = "a boundary condition without a name of its own", .where = place});
    }
    if (!std::isfinite(values[i]))
      throw InputError({.what = "a boundary condition that is not finite", .where = place});
    const auto& unit = base::unit(symbols[i]);
    inputs.push_back({.name = names[i], .unit = unit.si, .display_unit = unit.symbol});
    one.record.inputs.values.push_back(unit.to_si(values[i]));
  }
  one.schema = field::InputSchema(std::move(inputs));
}

}  // namespace

void read_el3d_mesh(const io::Hdf5File& file, CfdCase& one) {
  const auto centre = file.dataset("mesh/centre");
  centre.expect_shape({0, 3});
  const auto n = centre.shape()[0];
  if (n == 0) throw InputError({.what = "no cells", .where = centre.where()});
  const auto metres =
      centre.has_attribute("unit") ? unit_of(centre, centre.text("unit"), "m") : base::unit("m");
  const auto values = centre.read<double>();
  one.centre = Eigen::Map<const MatrixD>(values.data(), static_cast<Eigen::Index>(n), 3) * metres.factor;
  if (!one.centre.allFinite())
    throw InputError({.what = "a coordinate that is not finite", .where = centre.where()});
  if (!file.has("mesh/volume")) return;
  const auto volume = file.dataset("mesh/volume");
  volume.expect_shape({n});
  (void)(volume.has_attribute("unit") ? unit_of(volume, volume.text("unit"), "m3") : base::unit("m3"));
  one.volume = volume.read<double>();
  const auto bad = std::find_if_not(one.volume.begin(), one.volume.end(),
                                    [](double v) { return v > 0 && std::isfinite(v); });
  if (bad == one.volume.end()) return;
  throw InputError({.what = "a cell without volume",
                    .where = volume.where() + ", cell " + std::to_string(bad - one.volume.begin()),
                    .found = base::number(*bad)});
}

CfdCase read_el3d(const std::filesystem::path& path) {
  const auto file = io::Hdf5File::open(path);
  CfdCase one;
  one.record.source = path.filename().string();
  one.record.source_digest = base::sha256_file(path);
  one.record.inputs.name = file.has_attribute("case") ? file.text("case") : path.stem().string();
  one.record.inputs.load = file.has_attribute("load") ? file.number("load") : std::nan("");
  if (file.has_attribute("averaging_window_s"))
    one.record.averaging_window_s = file.number("averaging_window_s");
  read_el3d_mesh(file, one);
  if (one.volume.empty())
    throw InputError({.what = "no volumes of cells", .where = path.string(), .expected = "/mesh/volume"});
  read_fields(file, one);
  read_boundary_conditions(file, one);
  return one;
}

}  // namespace elrom::ingest
