#include "support/benchmark.hpp"

#include <nlohmann/json.hpp>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/comma_list.hpp"
#include "elrom/base/version.hpp"

namespace elrom::benchmark {

CommandLine::CommandLine(const std::string& what) : app_(what) {}

void CommandLine::add(const std::string& name, bool& value, const std::string& help) {
  app_.add_flag(name, value, help);
}
void CommandLine::add(const std::string& name, int& value, const std::string& help) {
  app_.add_option(name, value, help)->capture_default_str();
}
void CommandLine::add(const std::string& name, std::string& value, const std::string& help, Need need) {
  app_.add_option(name, value, help)->required(need == Need::required)->capture_default_str();
}
void CommandLine::add(const std::string& name, std::filesystem::path& value, const std::string& help,
                      Need need) {
  app_.add_option(name, value, help)->required(need == Need::required)->capture_default_str();
}
void CommandLine::add_list(const std::string& name, std::vector<std::string>& values,
                           const std::string& help) {
  base::comma_list(app_.add_option(name, values, help))->capture_default_str();
}
void CommandLine::add_repeated(const std::string& name, std::vector<std::string>& values,
                               const std::string& help) {
  base::repeatable(app_.add_option(name, values, help));
}

std::optional<int> CommandLine::parse(int argc, char** argv) { return app_.parse(argc, argv); }

void Arguments::add_to(CommandLine& line, const std::string& store_help, CommandLine::Need store_need) {
  line.add("--json", json, "write the figures to this file");
  line.add("--store", store, store_help, store_need);
  line.add("--small", small, "a version that ends within a minute");
  line.add("--threads", threads, "threads of the work that is measured");
}

void StudyArguments::add_to(CommandLine& line) {
  Arguments::add_to(line, "snapshot store", CommandLine::Need::required);
  line.add("--effort", effort, "of the studies");
  line.add_repeated("--set", settings, "key=value: a setting of the studies; repeatable");
  line.add("--folder", folder, "keep the studies here, and go on from those that are there");
}

nlohmann::ordered_json trained_report(const StudyArguments& arguments, const std::filesystem::path& folder,
                                      const std::filesystem::path& store,
                                      const std::vector<std::string>& further) {
  const auto file = folder / "accuracy.json";
  std::filesystem::create_directories(folder);
  std::vector<std::string> words{"run",          folder.string(),  "--store",
                                 store.string(), "--threads",      std::to_string(arguments.threads),
                                 "--effort",     arguments.effort, "-q"};
  for (const auto* settings : {&further, &arguments.settings})
    for (const auto& setting : *settings) words.push_back("--set=" + setting);
  run_program(sibling("elrom-train"), words);
  run_program(sibling("elrom-report"),
              {"accuracy", folder.string(), "--store", store.string(), "--quiet", "--json", file.string()});
  return nlohmann::ordered_json::parse(base::read_text(file));
}

int show(nlohmann::ordered_json json, bool small, const std::filesystem::path& file) {
  json["program"] = program_version();
  json["small"] = small;
  const auto text = json.dump(1) + "\n";
  std::fputs(text.c_str(), stdout);
  if (!file.empty()) base::write_text(file, text);
  return 0;
}

int benchmark_main(const std::string& name, const std::string& what, const std::string& store_help, int argc,
                   char** argv, const std::function<nlohmann::ordered_json(const Arguments&)>& measure) {
  return base::run_app(name, [&] {
    CommandLine line(what);
    Arguments arguments;
    arguments.add_to(line, store_help);
    if (const auto status = line.parse(argc, argv)) return *status;
    return show(measure(arguments), arguments.small, arguments.json);
  });
}

}  // namespace elrom::benchmark
