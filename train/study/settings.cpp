#include "elrom/study/settings.hpp"

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/parallel.hpp"
#include "settings_table.hpp"

namespace elrom::study {

int Settings::n_threads() const { return threads > 0 ? threads : base::available_threads(); }

Settings read_settings(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  std::vector<io::SettingValue> sources;  // the later wins
  if (std::filesystem::exists(file))
    sources.push_back(io::parse_settings(base::read_text(file), file.string()));
  for (const auto& text : overrides) sources.push_back(io::parse_override(text));

  Settings settings;
  const auto& table = settings_table();
  for (const auto& source : sources)
    if (const auto* effort = source.member("effort")) table.find("effort")->read(settings, *effort);
  apply_effort(settings);
  for (const auto& source : sources) table.read(settings, source);
  return settings;
}

std::string to_toml(const Settings& settings, std::string_view section) {
  return settings_table().write(settings, section);
}

std::vector<SettingHelp> settings_help() {
  Settings defaults;
  apply_effort(defaults);
  std::vector<SettingHelp> help;
  for (const auto& row : settings_table().rows()) help.push_back({row.key, row.write(defaults), row.meaning});
  return help;
}

}  // namespace elrom::study
