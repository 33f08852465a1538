#pragma once
// A small EL3D export, written as another program would write it, with every part open to damage.

#include <string>
#include <vector>

#include "elrom/field/catalogue.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::test {

struct El3dExport {
  field::Mesh mesh = field::make_furnace_mesh({}, 2, 3, 4);
  std::string name = "a";
  double load = 0.5;
  double shift = 0;  ///< added to every field, so that cases differ
  std::vector<std::string> input_names{"primary_air", "gas_temperature"};
  std::vector<std::string> input_units{"kg/s", "degC"};
  std::vector<double> input_values{160, 800};
  std::string pressure_unit = "Pa";
  std::string leave_out;  ///< a field
  bool with_nan = false;

  void write(const std::filesystem::path& path) const {
    auto file = io::Hdf5File::create(path);
    file.set_text("case", name);
    file.set_number("load", load);
    file.set_number("averaging_window_s", 24);
    const auto n = mesh.n_cells();
    const auto group = file.create_group("mesh");
    group.write<double>("centre", {mesh.centre.data(), 3 * n}, {n, 3}).set_text("unit", "m");
    group.write<double>("volume", mesh.volume).set_text("unit", "m3");
    const auto fields = file.create_group("fields");
    for (const auto& field : field::standard_fields()) {
      if (field.name == leave_out) continue;
      std::vector<float> values(n);
      for (std::size_t i = 0; i < n; ++i)
        values[i] = static_cast<float>(0.1 + shift + 0.001 * static_cast<double>(i));
      if (with_nan && field.name == "pressure") values[5] = std::numeric_limits<float>::quiet_NaN();
      fields.write<float>(field.name, values)
          .set_text("unit", field.name == "pressure" ? pressure_unit : field.unit);
    }
    const auto conditions = file.write<double>("boundary_conditions", input_values);
    conditions.set_texts("names", input_names);
    conditions.set_texts("units", input_units);
    file.close();
  }
};

}  // namespace elrom::test
