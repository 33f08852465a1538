#pragma once
// Drawn sections of the page of scenes; each returns HTML, empty where the runs have nothing to draw.

#include <string>

#include "elrom/report/scenes.hpp"

namespace elrom::report {

/// Class of a run's lines, the same in every drawing: "truth" is the yardstick.
[[nodiscard]] std::string run_class(const SceneReport& report, std::size_t run);
[[nodiscard]] std::string run_legend(const SceneReport& report);

/// Profiles across at every station along each section.
[[nodiscard]] std::string profiles_section(const SceneReport& report);
/// Where the spheres are at the end, coloured by group.
[[nodiscard]] std::string positions_section(const SceneReport& report);
/// Volume fractions of the sections' cells on a logarithmic scale.
[[nodiscard]] std::string fractions_section(const SceneReport& report);

}  // namespace elrom::report
