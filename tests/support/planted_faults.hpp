#pragma once
// What goes wrong with exports, done to a case as read: for the tests and the benchmark of the checks.

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/ingest/cfd_case.hpp"

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
       [](CfdCase& one, std::size_t) {
         one.values.row(row_of(one, "gas_velocity_z")).swap(one.values.row(row_of(one, "solid_velocity_z")));
       }},
      {"beyond_bounds",
       [](CfdCase& one, std::size_t variant) {
         const auto cell = static_cast<Eigen::Index>(variant * 997) % one.values.cols();
         one.values(row_of(one, variant % 2 == 0 ? "solid_volume_fraction" : "solid_diameter"), cell) = -0.1F;
       }},
  };
  return faults;
}

}  // namespace elrom::test
