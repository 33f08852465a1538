#include "elrom/serve/service.hpp"
#include "process.hpp"

namespace elrom::serve {

void judge_in_process(const std::filesystem::path& program, const std::filesystem::path& file,
                      const std::filesystem::path& bundle) {
  constexpr int patience_s = 60;
  std::vector<std::string> command{program.string(), "--judge-fields", file.string()};
  if (!bundle.empty()) command.insert(command.end(), {"--model", bundle.string()});
  const auto ended = run_process(command, patience_s);
  if (!ended.in_time)
    throw InputError(Problem{.what = "reading the file comes to no end",
                             .where = file.filename().string(),
                             .expected = "at most " + std::to_string(patience_s) + " s"});
  if (ended.status == 0) return;
  if (ended.status > 0 && !ended.said.empty()) throw InputError(ended.reason());
  throw InputError(Problem{.what = "reading the file crashed", .where = file.filename().string()});
}

}  // namespace elrom::serve
