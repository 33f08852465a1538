#include "fuzz_targets.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "../../data/ingest/vtu.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/foam/foam_file.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "fuzz_bundles.hpp"
#include "fuzz_collisions.hpp"
#include "fuzz_service.hpp"
#include "memory_file.hpp"

namespace elrom::faults {
namespace {

const field::InputSchema& schema() {
  static const field::InputSchema schema({{"primary_air", "kg/s", "kg/s"},
                                          {"secondary_left", "kg/s", "t/h"},
                                          {"gas_temperature", "K", "degC"},
                                          {"solids_d50", "m", "um"},
                                          {"return_left_fraction", "1", "1"}});
  return schema;
}

void fuzz_cases(const std::string& name, Bytes input) {
  try {
    const auto path = memory_file(name, input);
    if (name.ends_with(".csv")) (void)field::read_schema(path);
    (void)field::read_cases(path, schema());
  } catch (const Error&) {
  }
}
void fuzz_cases_csv(Bytes input) { fuzz_cases("cases.csv", input); }
void fuzz_cases_json(Bytes input) { fuzz_cases("cases.json", input); }
void fuzz_cases_toml(Bytes input) { fuzz_cases("cases.toml", input); }

void fuzz_fluent(Bytes input) {
  try {
    (void)ingest::read_fluent_ascii(memory_file("table.txt", input));
  } catch (const Error&) {
  }
}

void fuzz_foam(Bytes input) {
  try {
    foam::FoamFile file(memory_file("foam", input));
    file.to_body();
    (void)file.vectors();
    if (file.seek("internalField")) (void)file.scalars();
  } catch (const Error&) {
  }
}

void fuzz_vtu(Bytes input) {
  try {
    (void)ingest::group_into_planes(ingest::read_vtu(memory_file("mesh.vtu", input)), {}, "mesh.vtu");
  } catch (const Error&) {
  }
}

}  // namespace

const std::vector<FuzzTarget>& fuzz_targets() {
  static const std::vector<FuzzTarget> targets = [] {
    std::vector<FuzzTarget> all = {{"bundle", fuzz_bundle},
                                   {"bundle_content", fuzz_bundle_content},
                                   {"cases_csv", fuzz_cases_csv},
                                   {"cases_json", fuzz_cases_json},
                                   {"cases_toml", fuzz_cases_toml},
                                   {"fluent_ascii", fuzz_fluent},
                                   {"foam", fuzz_foam},
                                   {"vtu", fuzz_vtu},
                                   {"collisions", fuzz_collisions},
                                   {"collisions_content", fuzz_collisions_content},
                                   {"collision_model", fuzz_collision_model},
                                   {"collision_model_content", fuzz_collision_model_content}};
#if ELROM_HAS_SERVE
    for (auto& target : service_targets()) all.push_back(std::move(target));
#endif
    return all;
  }();
  return targets;
}

std::vector<std::string> seeds_of(const std::string& target) {
  namespace fs = std::filesystem;
  std::vector<std::string> seeds;
  if (target == "bundle") {
    const auto path = memory_folder() / "seed.elrom";
    const auto add = [&](const auto& bundle) {
      bundle.write(path);
      seeds.push_back(test::read_bytes(path));
    };
    add(tiny_bundle());
    for (const auto& [name, bundle] : small_bundles()) add(bundle);
  }
  if (target.starts_with("collision")) seeds = collision_seeds(target);
#if ELROM_HAS_SERVE
  if (const auto found = service_seeds(target); !found.empty()) seeds = found;
#endif
  std::vector<fs::path> files;
  const auto corpus = fs::path(ELROM_SOURCE_DIR) / "tests/faults/corpus" / target;
  if (fs::exists(corpus)) files.assign(fs::directory_iterator(corpus), fs::directory_iterator());
  std::sort(files.begin(), files.end());
  for (const auto& file : files) seeds.push_back(test::read_bytes(file));
  return seeds;
}

}  // namespace elrom::faults
