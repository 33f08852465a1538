#include "elrom/study/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "settings_table.hpp"

namespace elrom::study {
namespace {

std::vector<std::string> known_keys() {
  std::vector<std::string> keys{"symmetry.mirror"};
  for (const auto& row : setting_rows()) keys.push_back(row.key);
  return keys;
}

std::string place(const std::string& file, const toml::node& node) {
  return node.source().begin.line > 0 ? fmt::format("{}:{}", file, node.source().begin.line) : file;
}

std::string shown(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_value<decltype(value)>)
      text << value;
    else if constexpr (toml::is_array<decltype(value)>)
      text << value;
    else
      text << "a table";
  });
  return text.str();
}

std::string key_advice(const std::string& key) {
  const auto keys = known_keys();
  if (const auto near = base::closest_name(key, keys)) return "did you mean '" + *near + "'?";
  const auto dot = key.rfind('.');
  std::vector<std::string> names;
  for (const auto& row : setting_rows()) {
    const bool same_section = dot != std::string::npos && row.section() == key.substr(0, dot);
    if (same_section || (dot == std::string::npos && row.section().empty())) names.push_back(row.key);
    if (row.name() == (dot == std::string::npos ? key : key.substr(dot + 1)))
      return "did you mean '" + row.key + "'?";
  }
  return names.empty() ? "all keys are listed by elrom-train run --help"
                       : "known there are: " + base::join(names, ", ");
}

[[noreturn]] void refuse_value(const std::string& key, const toml::node& node, const std::string& where,
                               const std::string& expected) {
  throw UsageError({.what = "setting " + key, .where = where, .found = shown(node), .expected = expected});
}

std::vector<std::pair<std::string, std::string>> read_swaps(const toml::node* node) {
  std::vector<std::pair<std::string, std::string>> swaps;
  if (node == nullptr) return swaps;
  const auto* list = node->as_array();
  if (list == nullptr) throw std::string("swap = [[\"*_left\", \"*_right\"], ...]");
  for (const auto& item : *list) {
    const auto* pair = item.as_array();
    if (pair == nullptr || pair->size() != 2 || !(*pair)[0].is_string() || !(*pair)[1].is_string()) {
      throw std::string("swap = [[\"*_left\", \"*_right\"], ...]");
    }
    swaps.emplace_back(**(*pair)[0].as_string(), **(*pair)[1].as_string());
  }
  return swaps;
}

field::MirrorDeclaration read_mirror(const toml::table& table) {
  const std::vector<std::string> known{"name", "axis", "swap", "complement"};
  for (const auto& [key, value] : table) {
    const std::string name(key.str());
    if (std::ranges::find(known, name) == known.end())
      throw "name, axis, swap, complement (" + base::name_advice(name, known) + ")";
  }
  field::MirrorDeclaration mirror;
  mirror.name = table["name"].value_or(std::string("mirror"));
  const auto axis = table["axis"].value_or(std::string());
  if (axis != "x" && axis != "y") throw std::string("axis = \"x\" or \"y\"");
  mirror.axis = axis[0];
  mirror.swap = read_swaps(table.get("swap"));
  if (const auto* list = table["complement"].as_array()) {
    for (const auto& item : *list) {
      if (!item.is_string()) throw std::string("complement = [\"input\", ...]");
      mirror.complement.push_back(**item.as_string());
    }
  }
  return mirror;
}

void read_mirrors(Settings& settings, const toml::node& node, const std::string& where) {
  try {
    const auto* list = node.as_array();
    if (list == nullptr) throw std::string("[[symmetry.mirror]] tables");
    for (const auto& item : *list) {
      if (!item.is_table()) throw std::string("[[symmetry.mirror]] tables");
      settings.symmetry.mirrors.push_back(read_mirror(*item.as_table()));
    }
  } catch (const std::string& expected) {
    refuse_value("symmetry.mirror", node, where, expected);
  }
}

void read_key(Settings& settings, const std::string& key, const toml::node& node, const std::string& file) {
  const auto where = place(file, node);
  if (key == "symmetry.mirror") return read_mirrors(settings, node, where);
  const auto* row = find_setting(key);
  if (row == nullptr)
    throw UsageError({.what = "unknown setting '" + key + "'", .where = where, .advice = key_advice(key)});
  try {
    row->read(settings, node);
  } catch (const std::string& expected) {
    refuse_value(key, node, where, expected);
  }
}

void read_table(Settings& settings, const toml::table& table, const std::string& prefix,
                const std::string& file) {
  for (const auto& [name, node] : table) {
    const std::string key = prefix.empty() ? std::string(name.str()) : prefix + "." + std::string(name.str());
    const bool is_setting = find_setting(key) != nullptr;
    const bool is_section =
        std::ranges::any_of(setting_rows(), [&](const auto& row) { return row.section() == key; });
    if (node.is_table() && is_section && !is_setting)
      read_table(settings, *node.as_table(), key, file);
    else
      read_key(settings, key, node, file);
  }
}

toml::table parse(std::string_view text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw UsageError({.what = std::string("no valid TOML (") + std::string(error.description()) + ")",
                      .where = fmt::format("{}:{}", file, error.source().begin.line)});
  }
}

// "key=value": the value as TOML, or, where that is none, as a bare word.
toml::table parse_override(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw UsageError({.what = "no setting", .where = "--set", .found = text, .expected = "key=value"});
  }
  const auto key = base::trim(text.substr(0, equals)), value = base::trim(text.substr(equals + 1));
  try {
    return toml::parse(key + " = " + value);
  } catch (const toml::parse_error&) {
    toml::table table;
    std::string quoted;
    for (const char c : value) quoted += (c == '"' || c == '\\') ? std::string("\\") + c : std::string(1, c);
    return parse(key + " = \"" + quoted + "\"", "--set");
  }
}

std::optional<std::string> effort_of(const toml::table& table) {
  return table["effort"].value<std::string>();
}

std::string mirror_toml(const field::MirrorDeclaration& mirror) {
  std::vector<std::string> swaps, complements;
  for (const auto& [a, b] : mirror.swap) swaps.push_back(fmt::format("[\"{}\", \"{}\"]", a, b));
  for (const auto& name : mirror.complement) complements.push_back("\"" + name + "\"");
  return fmt::format("\n[[symmetry.mirror]]\nname = \"{}\"\naxis = \"{}\"\nswap = [{}]\ncomplement = [{}]\n",
                     mirror.name, mirror.axis, base::join(swaps, ", "), base::join(complements, ", "));
}

}  // namespace

int Settings::n_threads() const { return threads > 0 ? threads : base::available_threads(); }

Settings read_settings(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  toml::table from_file;
  if (std::filesystem::exists(file)) from_file = parse(base::read_text(file), file.string());
  std::vector<toml::table> from_line;
  for (const auto& text : overrides) from_line.push_back(parse_override(text));

  Settings settings;
  auto effort = effort_of(from_file);
  for (const auto& table : from_line) effort = effort_of(table) ? effort_of(table) : effort;
  try {
    apply_effort(settings, effort.value_or("standard"));
  } catch (const std::string& expected) {
    throw UsageError(
        {.what = "setting effort", .where = file.string(), .found = *effort, .expected = expected});
  }
  read_table(settings, from_file, "", file.string());
  for (const auto& table : from_line) read_table(settings, table, "", "--set");
  return settings;
}

std::string to_toml(const Settings& settings, std::string_view section) {
  std::string text, open;
  for (const auto& row : setting_rows()) {
    if (!section.empty() && row.section() != section) continue;
    if (row.section() != open) {
      if (open == "symmetry")
        for (const auto& mirror : settings.symmetry.mirrors) text += mirror_toml(mirror);
      open = row.section();
      text += fmt::format("\n[{}]\n", open);
    }
    text += fmt::format("{} = {}\n", row.name(), row.write(settings));
  }
  if (open == "symmetry")
    for (const auto& mirror : settings.symmetry.mirrors) text += mirror_toml(mirror);
  return text;
}

std::vector<SettingHelp> settings_help() {
  Settings defaults;
  apply_effort(defaults, "standard");
  std::vector<SettingHelp> help;
  for (const auto& row : setting_rows()) help.push_back({row.key, row.write(defaults), row.meaning});
  return help;
}

std::vector<field::MirrorDeclaration> furnace_mirrors() {
  return {{.name = "left-right",
           .axis = 'y',
           .swap = {{"*_left", "*_right"}},
           .complement = {"return_left_fraction"}},
          {.name = "front-rear",
           .axis = 'x',
           .swap = {{"secondary_front_*", "secondary_rear_*"},
                    {"fuel_front_*", "fuel_rear_*"},
                    {"return_front_*", "return_rear_*"}},
           .complement = {}}};
}

}  // namespace elrom::study
