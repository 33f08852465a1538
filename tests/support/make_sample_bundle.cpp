// make-sample-bundle FOLDER [full [BUILDS [UNITS [half]]]]: FOLDER/model.elrom with random weights,
// FOLDER/cases.csv. "full": nine fields, 26 inputs, 66 planes of 840 columns, four submodels a field, three
// hidden layers. FOLDER/furnace.elrom is the small one with inputs and a furnace that physics audits know.
#include <cstdlib>
#include <fstream>
#include <string_view>

#include "elrom/base/app.hpp"
#include "support/sample_bundle.hpp"

namespace {

elrom::test::BundleSize size_of(int argc, char** argv) {
  if (argc < 3) return {};
  elrom::test::BundleSize size{.n_x = 20, .n_y = 42, .n_planes = 66, .n_inputs = 26, .n_cases = 64};
  size.n_submodels = 4;
  size.n_layers = 3;
  size.n_builds = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 5;
  size.n_units = argc > 4 ? std::strtoul(argv[4], nullptr, 10) : 128;
  size.half_precision = argc > 5;
  size.with_uncertainty = false;
  return size;
}

/// 1,000 cases inside the trained range, the first of which is the sample's own.
void write_cases(const std::filesystem::path& path, const elrom::test::BundleSize& size) {
  std::ofstream file(path);
  file << "case,load";
  for (std::size_t i = 0; i < size.n_inputs; ++i) file << ",flow_" << i << " [kg/s]";
  for (int k = 0; k < 1000; ++k) {
    const double load = 0.7 + 0.0002 * k;
    file << "\ncase_" << k << "," << load;
    for (std::size_t i = 0; i < size.n_inputs; ++i) file << "," << 10.0 * static_cast<double>(i + 1) * load;
  }
  file << "\n";
}

elrom::model::Bundle with_furnace(elrom::model::Bundle bundle) {
  bundle.info.schema = elrom::field::InputSchema({{"primary_air", "kg/s", "kg/s"},
                                                  {"burner_left", "kg/s", "kg/s"},
                                                  {"solids_inventory", "kg", "t"},
                                                  {"gas_temperature", "K", "K"}});
  bundle.furnace = elrom::field::read_furnace(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml");
  return bundle;
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::base::run_app("make-sample-bundle", [&] {
    const std::filesystem::path folder = argc > 1 ? argv[1] : ".";
    std::filesystem::create_directories(folder);
    const auto size = size_of(argc, argv);
    elrom::test::sample_bundle(size).write(folder / "model.elrom");
    if (argc < 3) with_furnace(elrom::test::sample_bundle(size)).write(folder / "furnace.elrom");
    write_cases(folder / "cases.csv", size);
    return 0;
  });
}
