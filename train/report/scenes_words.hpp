#pragma once
// How the figures of scenes are written, in the terminal and on the page.

#include <string>

#include "elrom/report/scenes.hpp"

namespace elrom::report {

/// "0.1 ms"
[[nodiscard]] std::string time_text(double seconds);
/// "19 ms", "2 min 40 s"
[[nodiscard]] std::string run_time_text(double seconds);
/// "+1.2 %"
[[nodiscard]] std::string signed_percent(double share);
/// What to think of a run's figures.
[[nodiscard]] std::string note_text(const SceneReport& report, const SceneRunReport& run);
/// "DEM" where the reference is; else its name.
[[nodiscard]] std::string reference_text(const SceneReport& report);

}  // namespace elrom::report
