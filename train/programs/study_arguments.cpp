#include <fmt/format.h>

#include "commands.hpp"
#include "elrom/base/comma_list.hpp"

namespace elrom::programs {
namespace {

std::string settings_footer() {
  std::string text = "Settings of study.toml, with their defaults at effort = \"standard\":\n";
  for (const auto& setting : study::settings_help()) {
    text += fmt::format("  {:<26} {}\n      {}\n", setting.key, setting.value, setting.meaning);
  }
  return text;
}

}  // namespace

void StudyArguments::add_to(cli::App& command) {
  command.add_option("STUDY", folder, "folder of the study; study.toml in it is optional")->required();
  command.add_option(
      "--store", store,
      "snapshot store [the setting store; the one of the last run; snapshots.h5 in the folder]");
  command.add_option("--effort", effort, "quick, standard or thorough [the setting effort, standard]")
      ->check(cli::IsMember({"quick", "standard", "thorough"}));
  command.add_option("--threads", threads, "threads of every stage, 0: all [the setting threads, 0]");
  command.add_option("--device", device, "where LibTorch trains: cpu or cuda [the setting device, cpu]");
  command.add_option("--date", date, "kept in the model and the log of versions [the setting date: none]");
  base::repeatable(command.add_option("--set", settings,
                                      "key=value: a setting of study.toml, wins over the file; repeatable"));
  command.add_flag("--quiet,-q", quiet, "warnings only");
  command.footer(settings_footer);
}

study::Settings StudyArguments::resolve() const {
  auto overrides = settings;
  const auto quoted = [](const std::string& text) { return "\"" + text + "\""; };
  if (!store.empty()) overrides.push_back("store='" + std::filesystem::absolute(store).string() + "'");
  if (!effort.empty()) overrides.push_back("effort=" + quoted(effort));
  if (!device.empty()) overrides.push_back("device=" + quoted(device));
  if (!date.empty()) overrides.push_back("date=" + quoted(date));
  if (threads >= 0) overrides.push_back("threads=" + std::to_string(threads));
  return study::study_settings(folder, overrides);
}

std::unique_ptr<Log> StudyArguments::log() const {
  return make_console_log(quiet ? Level::warning : Level::info);
}

}  // namespace elrom::programs
