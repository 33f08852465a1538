#include "hard_data.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace elrom::stability {
namespace {

struct Size {
  std::size_t n_cases = 12, n_x = 3, n_y = 2, n_planes = 4;
};

field::InputSchema schema() {
  return field::InputSchema({{"primary_air", "kg/s", "kg/s"},
                             {"secondary_left", "kg/s", "t/h"},
                             {"gas_temperature", "K", "degC"},
                             {"solids_d50", "m", "um"},
                             {"return_left_fraction", "1", "1"}});
}

/// A healthy set: inputs follow a load with scatter, fields are smooth functions of inputs and place.
HardData healthy(const std::string& name, const std::string& description, const Size& size = {}) {
  HardData data{.name = name, .description = description, .cases = {}, .fields = {}, .values = {}};
  data.cases.mesh = field::make_furnace_mesh({}, size.n_x, size.n_y, size.n_planes);
  data.cases.schema = schema();
  data.fields = {field::field_info("gas_velocity_z"), field::field_info("solid_volume_fraction")};
  data.cases.mirrors = {
      field::resolve({.name = "left-right", .axis = 'x', .complement = {"return_left_fraction"}},
                     data.cases.schema, data.cases.mesh)};
  base::Random random(base::Seed(7).derive(name));
  const auto n = static_cast<Eigen::Index>(size.n_cases),
             n_cells = static_cast<Eigen::Index>(data.cases.mesh.n_cells());
  data.cases.inputs.resize(n, 5);
  data.values.assign(2, MatrixF(n, n_cells));
  for (Eigen::Index i = 0; i < n; ++i) {
    const double load = 0.4 + 0.6 * static_cast<double>(i) / std::max<double>(1, static_cast<double>(n - 1));
    data.cases.names.push_back("case_" + std::to_string(i));
    data.cases.loads.push_back(load);
    data.cases.inputs.row(i) << 200 * load * random.uniform(0.9, 1.1), 20 * load * random.uniform(0.8, 1.2),
        1100 * random.uniform(0.97, 1.03), 3e-4 * random.uniform(0.8, 1.2), random.uniform(0.3, 0.7);
    for (Eigen::Index c = 0; c < n_cells; ++c) {
      const double z = data.cases.mesh.centre(c, 2) / 47.0;
      data.values[0](i, c) = static_cast<float>(5 * load * (1 + 0.3 * z) + 0.1 * random.normal());
      data.values[1](i, c) = static_cast<float>(0.3 * std::exp(-6 * z / load) * random.uniform(0.9, 1.1));
    }
  }
  return data;
}

HardData changed(HardData data, const std::function<void(HardData&)>& change) {
  change(data);
  return data;
}

/// Inputs of the shipped training cases, as many cases of them as shipped.
HardData shipped_inputs() {
  const auto path = std::filesystem::path(ELROM_SOURCE_DIR) / "data/cases/cases.csv";
  const auto schema = field::read_schema(path);
  const auto cases = field::read_cases(path, schema);
  auto data = healthy("shipped_inputs", "the 26 inputs of the shipped cases", {.n_cases = cases.size()});
  data.cases.schema = schema;
  data.cases.mirrors.clear();
  data.cases.inputs.resize(static_cast<Eigen::Index>(cases.size()), static_cast<Eigen::Index>(schema.size()));
  for (std::size_t i = 0; i < cases.size(); ++i) {
    std::copy(cases[i].values.begin(), cases[i].values.end(),
              data.cases.inputs.row(static_cast<Eigen::Index>(i)).begin());
  }
  data.corners_are_outside = true;
  return data;
}

void add_degenerate_shapes(std::vector<HardData>& all) {
  all.push_back(healthy("healthy", "nothing hard: shows that the others fail for their own reason"));
  all.push_back(shipped_inputs());
  all.push_back(healthy("one_plane", "a mesh of one plane", {.n_planes = 1}));
  all.push_back(healthy("one_column", "a mesh of one column", {.n_x = 1, .n_y = 1}));
  all.push_back(healthy("one_cell", "a mesh of a single cell", {.n_x = 1, .n_y = 1, .n_planes = 1}));
  all.push_back(healthy("two_cases", "two cases in all", {.n_cases = 2}));
  all.push_back(healthy("one_case", "one case in all", {.n_cases = 1}));
}

void add_degenerate_fields(std::vector<HardData>& all) {
  all.push_back(changed(healthy("constant_columns", "half the cells have the same value in every case"),
                        [](HardData& d) {
                          for (auto& v : d.values) v.leftCols(v.cols() / 2).setConstant(0.25f);
                        }));
  all.push_back(changed(healthy("zero_fields", "every field is zero everywhere"), [](HardData& d) {
    for (auto& v : d.values) v.setZero();
  }));
  all.push_back(changed(healthy("wild_cell", "one cell of one case holds 1e30"),
                        [](HardData& d) { d.values[0](3, 5) = 1e30f; }));
  all.push_back(changed(healthy("near_overflow", "values of 1e38, whose squares overflow float"),
                        [](HardData& d) { d.values[0] *= 2e37f; }));
  all.push_back(changed(healthy("twelve_decades", "one field spans twelve decades"), [](HardData& d) {
    base::Random random(base::Seed(3).derive("decades"));
    auto& v = d.values[1];
    for (Eigen::Index i = 0; i < v.size(); ++i)
      v.data()[i] = static_cast<float>(std::pow(10, random.uniform(-12.5, -0.3)));
  }));
  all.push_back(changed(healthy("denormals", "values below the smallest normal float"), [](HardData& d) {
    for (auto& v : d.values) v *= 1e-41f;
  }));
  const auto spoil = [](float value) {
    return [value](HardData& d) {
      d.values[1](2, 3) = value;
      d.must_be_refused = true;
    };
  };
  all.push_back(
      changed(healthy("nan_cell", "one cell is NaN"), spoil(std::numeric_limits<float>::quiet_NaN())));
  all.push_back(changed(healthy("infinite_cell", "one cell is infinite"),
                        spoil(std::numeric_limits<float>::infinity())));
}

void add_degenerate_inputs(std::vector<HardData>& all) {
  all.push_back(changed(healthy("constant_inputs", "two inputs never change"), [](HardData& d) {
    d.cases.inputs.col(1).setConstant(12);
    d.cases.inputs.col(2).setConstant(1100);
  }));
  all.push_back(changed(healthy("all_inputs_constant", "no input ever changes"), [](HardData& d) {
    for (Eigen::Index i = 1; i < d.cases.inputs.rows(); ++i) d.cases.inputs.row(i) = d.cases.inputs.row(0);
  }));
  all.push_back(
      changed(healthy("correlated_inputs", "all inputs are multiples of the first"), [](HardData& d) {
        for (Eigen::Index k = 1; k < d.cases.inputs.cols(); ++k) {
          d.cases.inputs.col(k) = d.cases.inputs.col(0) * (0.001 * static_cast<double>(k));
        }
      }));
  all.push_back(changed(healthy("duplicate_cases", "half the cases repeat the others, fields and all"),
                        [](HardData& d) {
                          const auto half = d.cases.inputs.rows() / 2;
                          d.cases.inputs.bottomRows(half) = d.cases.inputs.topRows(half).eval();
                          for (auto& v : d.values) v.bottomRows(half) = v.topRows(half).eval();
                        }));
  all.push_back(
      changed(healthy("contradicting_cases", "the same inputs with different fields"), [](HardData& d) {
        const auto half = d.cases.inputs.rows() / 2;
        d.cases.inputs.bottomRows(half) = d.cases.inputs.topRows(half).eval();
      }));
  all.push_back(changed(healthy("tiny_range", "inputs differ in the twelfth digit only"), [](HardData& d) {
    for (Eigen::Index i = 0; i < d.cases.inputs.rows(); ++i) {
      d.cases.inputs.row(i) = d.cases.inputs.row(0) * (1 + 1e-12 * static_cast<double>(i));
    }
  }));
  all.push_back(changed(healthy("extreme_inputs", "one input of 1e200, one of 1e-310"), [](HardData& d) {
    d.cases.inputs.col(0) *= 1e200;
    d.cases.inputs.col(3) *= 1e-310;
  }));
}

}  // namespace

std::vector<HardData> all_hard_data() {
  std::vector<HardData> all;
  add_degenerate_shapes(all);
  add_degenerate_fields(all);
  add_degenerate_inputs(all);
  return all;
}

}  // namespace elrom::stability
