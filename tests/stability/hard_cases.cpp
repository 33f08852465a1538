// Prints what becomes of every hard case: finite numbers or one clear error. Exit status 1 when any fails.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/cli/cli.hpp"
#include "stages.hpp"
#include "support/temporary_folder.hpp"

namespace {

int run(const std::string& json) {
  const elrom::test::TemporaryFolder folder;
  std::size_t passed = 0, of = 0;
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& data : elrom::stability::all_hard_data()) {
    fmt::print("{}: {}\n", data.name, data.description);
    for (const auto& outcome : elrom::stability::send_through(data, folder.path())) {
      fmt::print("  {:<18}{}{}\n", outcome.stage, outcome.passed ? "" : "FAILED: ", outcome.result);
      passed += outcome.passed ? 1 : 0;
      ++of;
      rows.push_back({{"data", data.name},
                      {"stage", outcome.stage},
                      {"passed", outcome.passed},
                      {"result", outcome.result}});
    }
  }
  fmt::print("{} of {} end in finite numbers or a clear error\n", passed, of);
  if (!json.empty()) {
    const nlohmann::ordered_json report{{"hard_cases", {{"passed", passed}, {"of", of}}}, {"outcomes", rows}};
    elrom::base::write_text(json, report.dump(2) + "\n");
  }
  return passed == of ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::base::run_app("hard_cases", [&] {
    elrom::cli::App app(
        "What becomes of every hard case of data: constant columns, wild cells, two cases ...");
    std::string json;
    bool small = false;
    app.add_option("--json", json, "Write the table to this file too");
    app.add_flag("--small", small, "Accepted for uniformity: the table takes seconds as it is");
    if (const auto status = app.parse(argc, argv)) return *status;
    return run(json);
  });
}
