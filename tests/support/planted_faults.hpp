#pragma once
// What goes wrong with exports, done to a case as read: for the tests and the benchmark of the checks.

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "support/shipped_instants.hpp"

namespace elrom::test {

inline Eigen::Index row_of(const ingest::CfdCase& one, std::string_view field) {
  for (std::size_t f = 0; f < one.fields.size(); ++f)
    if (one.fields[f].name == field) return static_cast<Eigen::Index>(f);
  throw std::logic_error("no such field");
}

struct PlantedFault {
  std::string kind;
  /// @param variant which field, inlet or factor; any number
  std::function<void(ingest::CfdCase&, std::size_t variant)> plant;
};

inline void scale_field(ingest::CfdCase& one, std::string_view name, float factor) {
  one.values.row(row_of(one, name)) *= factor;
}

inline void shuffle_cells(ingest::CfdCase& one, std::size_t variant) {
  const auto field = static_cast<Eigen::Index>(variant % one.fields.size());
  std::vector<Eigen::Index> order(static_cast<std::size_t>(one.values.cols()));
  std::iota(order.begin(), order.end(), 0);
  base::Random(base::Seed(1).derive("cells").derive(variant)).shuffle(order);
  const Eigen::RowVectorXf before = one.values.row(field);
  for (std::size_t i = 0; i < order.size(); ++i)
    one.values(field, static_cast<Eigen::Index>(i)) = before[order[i]];
}

/// The primary air's value and that of another inlet.
inline void exchange_inlets(ingest::CfdCase& one, std::size_t variant) {
  const auto primary = one.schema.index_of("primary_air");
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < one.schema.size(); ++i)
    if (one.schema[i].unit == "kg/s" && i != primary) others.push_back(i);
  std::swap(one.record.inputs.values[primary], one.record.inputs.values[others[variant % others.size()]]);
}

inline void turn_over(ingest::CfdCase& one) {
  auto z = one.centre.col(2);
  z = (z.minCoeff() + z.maxCoeff() - z.array()).matrix().eval();
}

inline void exchange_fields(ingest::CfdCase& one, const std::string& a, const std::string& b) {
  one.values.row(row_of(one, a)).swap(one.values.row(row_of(one, b)));
}

/// The gas's velocities in the place of the solids', as they are or as a line of them.
inline void copy_gas(ingest::CfdCase& one, std::size_t variant) {
  const auto random = std::make_unique<base::Random>(base::Seed(1).derive("copies").derive(variant));
  for (const std::string axis : {"x", "y", "z"}) {
    auto solid = one.values.row(row_of(one, "solid_velocity_" + axis));
    solid = one.values.row(row_of(one, "gas_velocity_" + axis));
    if (variant % 3 == 1) solid = (0.8F * solid.array() - 0.4F).matrix().eval();
    if (variant % 3 != 2) continue;
    const float noise = 0.01F * std::sqrt(solid.array().square().mean());
    for (auto& value : solid) value += noise * static_cast<float>(random->normal());
  }
}

/// Every second cell of some order is not there.
inline void lose_cells(ingest::CfdCase& one, std::size_t variant) {
  const auto n = one.values.cols();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(n)), kept;
  std::iota(order.begin(), order.end(), 0);
  if (variant % 3 == 0) base::Random(base::Seed(1).derive("lost").derive(variant)).shuffle(order);
  if (variant % 3 == 2)
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return one.centre(a, 2) < one.centre(b, 2); });
  for (std::size_t i = 0; i < order.size(); ++i)
    if (variant % 3 == 2 ? i % 20 < 10 : i % 2 == 0) kept.push_back(order[i]);
  std::sort(kept.begin(), kept.end());
  one.values = one.values(Eigen::all, kept).eval();
  one.centre = one.centre(kept, Eigen::all).eval();
  std::vector<double> volume;
  for (const auto i : kept) volume.push_back(one.volume[static_cast<std::size_t>(i)]);
  one.volume = volume;
}

/// What one of the shipped instants has that their average lacks, put onto the case: its differences for
/// velocities and pressure, its ratio for the volume fraction, and no solids where it has none.
inline void make_instant(ingest::CfdCase& one, std::size_t variant) {
  const auto& all = shipped_instants();
  const auto& instant = all.each[variant % all.each.size()];
  const auto& mean = all.mean;
  if (mean.values.cols() != one.values.cols()) throw std::logic_error("instants on another mesh");
  const auto row = [](ingest::CfdCase& of, const std::string& name) {
    return of.values.row(row_of(of, name));
  };
  const auto known = [](const ingest::CfdCase& of, const std::string& name) {
    return of.values.row(row_of(of, name)).array();
  };
  for (const std::string name : {"solid_velocity_x", "solid_velocity_y", "solid_velocity_z", "gas_velocity_x",
                                 "gas_velocity_y", "gas_velocity_z", "pressure"})
    row(one, name) += (known(instant, name) - known(mean, name)).matrix();
  const std::string fraction = "solid_volume_fraction";
  for (Eigen::Index i = 0; i < one.values.cols(); ++i) {
    const float now = known(instant, fraction)[i], usual = known(mean, fraction)[i];
    if (usual > 0) row(one, fraction)[i] = std::min(row(one, fraction)[i] * now / usual, 0.64F);
    if (row(one, fraction)[i] > 0) continue;
    for (const std::string axis : {"x", "y", "z"})
      row(one, "solid_velocity_" + axis)[i] = row(one, "gas_velocity_" + axis)[i];
  }
}

inline double gas_density(const ingest::CfdCase& one) {
  return 101325 / (287.05 * one.record.inputs.values[one.schema.index_of("gas_temperature")]);
}

inline double pick(std::initializer_list<double> values, std::size_t variant) {
  return values.begin()[variant % values.size()];
}

inline const std::vector<PlantedFault>& planted_faults() {
  using ingest::CfdCase;
  static const std::vector<PlantedFault> faults{
      {"gas_z_reversed", [](CfdCase& one, std::size_t) { scale_field(one, "gas_velocity_z", -1); }},
      {"solid_z_reversed", [](CfdCase& one, std::size_t) { scale_field(one, "solid_velocity_z", -1); }},
      {"height_reversed", [](CfdCase& one, std::size_t) { turn_over(one); }},
      {"mesh_scaled",
       [](CfdCase& one, std::size_t variant) {
         one.centre *= pick({0.7, 0.85, 1.4}, variant);
       }},
      {"fraction_inverted",
       [](CfdCase& one, std::size_t) {
         auto row = one.values.row(row_of(one, "solid_volume_fraction"));
         row = (1 - row.array()).matrix().eval();
       }},
      {"cells_shuffled", shuffle_cells},
      {"inlets_exchanged", exchange_inlets},
      {"inventory_off",
       [](CfdCase& one, std::size_t variant) {
         one.record.inputs.values[one.schema.index_of("solids_inventory")] *= pick({0.7, 1.4}, variant);
       }},
      {"fraction_off",
       [](CfdCase& one, std::size_t variant) {
         scale_field(one, "solid_volume_fraction", static_cast<float>(pick({0.7, 1.4}, variant)));
       }},
      {"gas_off",
       [](CfdCase& one, std::size_t variant) {
         scale_field(one, "gas_velocity_z", static_cast<float>(pick({0.6, 1.6}, variant)));
       }},
      {"pressure_reversed", [](CfdCase& one, std::size_t) { scale_field(one, "pressure", -1); }},
      {"fields_exchanged",
       [](CfdCase& one, std::size_t) { exchange_fields(one, "gas_velocity_z", "solid_velocity_z"); }},
      {"beyond_bounds",
       [](CfdCase& one, std::size_t variant) {
         const auto cell = static_cast<Eigen::Index>(variant * 997) % one.values.cols();
         one.values(row_of(one, variant % 2 == 0 ? "solid_volume_fraction" : "solid_diameter"), cell) = -0.1F;
       }},
      {"solid_z_constant", [](CfdCase& one, std::size_t) { scale_field(one, "solid_velocity_z", 0); }},
      {"solid_copies_gas", copy_gas},
      {"axes_exchanged",
       [](CfdCase& one, std::size_t) {
         for (const std::string phase : {"gas", "solid"})
           exchange_fields(one, phase + "_velocity_x", phase + "_velocity_y");
       }},
      {"pressure_kinematic",
       [](CfdCase& one, std::size_t) {
         scale_field(one, "pressure", static_cast<float>(1 / gas_density(one)));
       }},
      {"fraction_low", [](CfdCase& one, std::size_t) { scale_field(one, "solid_volume_fraction", 0.8F); }},
      {"cells_missing", lose_cells},
      {"instant", make_instant},
  };
  return faults;
}

}  // namespace elrom::test
