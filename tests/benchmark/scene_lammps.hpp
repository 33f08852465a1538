#pragma once
// A scene in one process and in several: elrom-simulate --engine lammps.

#include <nlohmann/json.hpp>
#include <string>

namespace elrom::benchmark {

/// A row for each number of processes: seconds of the clock, collisions, kinetic energy. Null, and a line
/// that says so, where this build has no LAMMPS. @param scene TOML
[[nodiscard]] nlohmann::ordered_json by_lammps(const std::string& scene);

}  // namespace elrom::benchmark
