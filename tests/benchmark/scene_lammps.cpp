#include "scene_lammps.hpp"

#include <fmt/format.h>

#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::benchmark {

using OrderedJson = nlohmann::ordered_json;

#ifdef ELROM_MPIEXEC
OrderedJson by_lammps(const std::string& scene) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("scene.toml", scene);
  auto rows = OrderedJson::array();
  for (const char* n_ranks : {"1", "2"}) {
    const auto output = folder / n_ranks, summary = output / "summary.json";
    run_program("/usr/bin/env", {"OMPI_ALLOW_RUN_AS_ROOT=1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
                                 "OMPI_MCA_rmaps_base_oversubscribe=1", "OMPI_MCA_mpi_yield_when_idle=1",
                                 "OMPI_MCA_hwloc_base_binding_policy=none", ELROM_MPIEXEC, "-n", n_ranks,
                                 sibling("elrom-simulate").string(), file.string(), "--output",
                                 output.string(), "--engine", "lammps"});
    const auto found = OrderedJson::parse(test::read_bytes(summary));
    rows.push_back({{"ranks", std::stoi(n_ranks)},
                    {"seconds", found["seconds"]},
                    {"collisions", found["collisions"]},
                    {"kinetic_energy_j", found["kinetic_energy_j"]}});
  }
  return rows;
}
#else
OrderedJson by_lammps(const std::string&) {
  fmt::print(stderr, "This build has no LAMMPS and MPI: no scene is run in several processes.\n");
  return nullptr;
}
#endif

}  // namespace elrom::benchmark
