#pragma once
// One row a setting: key, meaning, how it is read from TOML and written back. Internal to settings*.cpp.

#include <functional>
#include <string>
#include <vector>

#include "elrom/io/toml.hpp"
#include "elrom/study/settings.hpp"

namespace elrom::study {

struct SettingRow {
  std::string key;  ///< "screen.builds"
  std::string meaning;
  std::function<void(Settings&, const toml::node&)> read;  ///< throws std::string: what was expected
  std::function<std::string(const Settings&)> write;       ///< as TOML
  [[nodiscard]] std::string section() const;               ///< "screen"; empty for keys of the root
  [[nodiscard]] std::string name() const;                  ///< "builds"
};

[[nodiscard]] const std::vector<SettingRow>& setting_rows();
[[nodiscard]] const SettingRow* find_setting(std::string_view key);
/// Sets what an effort level means. @throws std::string for an unknown level
void apply_effort(Settings& settings, const std::string& effort);

}  // namespace elrom::study
