#pragma once
// The table of a study's settings. Internal to settings*.cpp.

#include "elrom/io/settings_table.hpp"
#include "elrom/study/settings.hpp"

namespace elrom::study {

[[nodiscard]] const io::SettingsTable<Settings>& settings_table();
/// Sets what the effort of these settings means.
void apply_effort(Settings& settings);

}  // namespace elrom::study
