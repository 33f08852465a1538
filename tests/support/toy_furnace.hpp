#pragma once
// A small furnace with mirrors and cases whose fields are
// known functions of the inputs: for tests of methods.

#include <cmath>
#include <string>

#include "elrom/base/random.hpp"
#include "elrom/methods/method.hpp"

namespace elrom::test {

/// 4 x 6 columns in 8 planes; air in four corners, a diameter, a temperature and a load that drives the air.
inline field::CaseSet toy_cases(std::size_t n_cases, bool mirrors = true) {
  field::CaseSet cases{.mesh = field::make_furnace_mesh({}, 4, 6, 8)};
  cases.schema = field::InputSchema({{"air_front_left", "kg/s", "kg/s"},
                                     {"air_front_right", "kg/s", "kg/s"},
                                     {"air_rear_left", "kg/s", "kg/s"},
                                     {"air_rear_right", "kg/s", "kg/s"},
                                     {"primary", "kg/s", "kg/s"},
                                     {"d50", "m", "um"},
                                     {"gas_temperature", "K", "degC"},
                                     {"split", "1", "1"}});
  base::Random random(base::Seed(21).derive("toy furnace"));
  cases.inputs.resize(static_cast<Eigen::Index>(n_cases), 8);
  for (std::size_t i = 0; i < n_cases; ++i) {
    const double load = 0.4 + 0.6 * (static_cast<double>(i) + 0.5) / static_cast<double>(n_cases);
    const auto row = static_cast<Eigen::Index>(i);
    for (Eigen::Index j = 0; j < 4; ++j) cases.inputs(row, j) = 10 * load * (1 + 0.1 * random.normal());
    cases.inputs.row(row).tail(4) << 80 * load * (1 + 0.05 * random.normal()),
        2e-4 * (1 + 0.1 * random.normal()), 1100 + 30 * random.normal(), 0.5 + 0.05 * random.normal();
    cases.names.push_back("case_" + std::to_string(i));
    cases.loads.push_back(load);
  }
  if (mirrors) {
    cases.mirrors = {
        field::resolve({"left-right", 'y', {{"*_left", "*_right"}}, {"split"}}, cases.schema, cases.mesh),
        field::resolve({"front-rear", 'x', {{"*_front_*", "*_rear_*"}}, {}}, cases.schema, cases.mesh)};
  }
  return cases;
}

/// Value of the toy's vertical velocity: grows with the air, more so on the side that gets more of it.
inline double toy_velocity(std::span<const double> q, double x, double y, double z) {
  const double total = q[0] + q[1] + q[2] + q[3] + q[4];
  const double right = (q[1] + q[3] - q[0] - q[2]) / (q[0] + q[1] + q[2] + q[3]);  // y grows to the right
  const double rear = (q[2] + q[3] - q[0] - q[1]) / (q[0] + q[1] + q[2] + q[3]);
  const double shape = 1 + std::cos(z / 20);
  return 0.02 * total * q[6] / 1100 * shape * (1 + right * (y - 13.8) / 13.8 + rear * (x - 5.3) / 5.3);
}

/// @param noise standard deviation added to every cell
inline field::FieldData toy_field(const field::CaseSet& cases, double noise = 0) {
  field::FieldData data{&cases, field::field_info("gas_velocity_z"), {}};
  base::Random random(base::Seed(22).derive("toy noise"));
  data.values.resize(cases.inputs.rows(), static_cast<Eigen::Index>(cases.mesh.n_cells()));
  for (Eigen::Index i = 0; i < data.values.rows(); ++i) {
    const std::span<const double> inputs(cases.inputs.row(i).data(), 8);
    for (Eigen::Index c = 0; c < data.values.cols(); ++c) {
      const auto& p = cases.mesh.centre;
      data.values(i, c) =
          static_cast<float>(toy_velocity(inputs, p(c, 0), p(c, 1), p(c, 2)) + noise * random.normal());
    }
  }
  return data;
}

}  // namespace elrom::test
