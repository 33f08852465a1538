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

int benchmark_main(const std::string& name, const std::string& what, const std::string& store_help, int argc,
                   char** argv, const std::function<nlohmann::ordered_json(const Arguments&)>& measure) {
  return base::run_app(name, [&] {
    CommandLine line(what);
    Arguments arguments;
    arguments.add_to(line, store_help);
    if (const auto status = line.parse(argc, argv)) return *status;
    auto json = measure(arguments);
    json["program"] = program_version();
    json["small"] = arguments.small;
    const auto text = json.dump(1) + "\n";
    std::fputs(text.c_str(), stdout);
    if (!arguments.json.empty()) base::write_text(arguments.json, text);
    return 0;
  });
}

}  // namespace elrom::benchmark
