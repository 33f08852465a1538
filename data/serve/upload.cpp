#include "elrom/base/shell.hpp"
#include "elrom/base/text.hpp"
#include "elrom/serve/service.hpp"

namespace elrom::serve {

void judge_in_process(const std::filesystem::path& program, const std::filesystem::path& file,
                      const std::filesystem::path& bundle) {
  constexpr double patience_s = 60;
  std::vector<std::string> command{program.string(), "--judge-fields", file.string()};
  if (!bundle.empty()) command.insert(command.end(), {"--model", bundle.string()});
  const auto ended = base::run_program(command, {.listen = true, .seconds = patience_s});
  if (ended.timed_out)
    throw InputError(Problem{.what = "reading the file comes to no end",
                             .where = file.filename().string(),
                             .expected = "at most " + base::duration(patience_s)});
  if (ended.well()) return;
  if (ended.status > 0 && !ended.said.empty()) throw InputError(ended.reason());
  throw InputError(Problem{.what = "reading the file crashed", .where = file.filename().string()});
}

}  // namespace elrom::serve
