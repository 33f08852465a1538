#include "elrom/study/settings.hpp"

#include <algorithm>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/parallel.hpp"
#include "settings_table.hpp"

namespace elrom::study {

namespace {

/// The file's, then the command line's: the later wins.
std::vector<io::SettingValue> sources_of(const std::filesystem::path& file,
                                         const std::vector<std::string>& overrides) {
  std::vector<io::SettingValue> sources;
  if (std::filesystem::exists(file))
    sources.push_back(io::parse_settings(base::read_text(file), file.string()));
  for (const auto& text : overrides) sources.push_back(io::parse_override(text));
  return sources;
}

Settings read_sources(const std::vector<io::SettingValue>& sources) {
  Settings settings;
  const auto& table = settings_table();
  for (const auto& source : sources)
    if (const auto* effort = source.member("effort")) table.find("effort")->read(settings, *effort);
  apply_effort(settings);
  for (const auto& source : sources) table.read(settings, source);
  return settings;
}

}  // namespace

int Settings::n_threads() const { return threads > 0 ? threads : base::available_threads(); }

Settings read_settings(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return read_sources(sources_of(file, overrides));
}

Settings study_settings(const std::filesystem::path& study, const std::vector<std::string>& overrides) {
  const auto sources = sources_of(study / "study.toml", overrides);
  auto settings = read_sources(sources);
  const bool is_named = std::ranges::any_of(
      sources, [](const io::SettingValue& source) { return source.member("store") != nullptr; });
  if (!is_named && std::filesystem::exists(study / "resolved.toml"))
    settings.store = read_settings(study / "resolved.toml").store;
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
