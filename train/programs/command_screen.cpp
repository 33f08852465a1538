#include <fmt/format.h>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/text.hpp"

namespace elrom::programs {
namespace {

// Cells as columns where a band has a mask: a column may belong to several bands then.
void print_bands(const std::vector<study::FieldOutcome>& outcomes) {
  fmt::print("{:<24} {:<14} {:>8}\n", "field", "band", "columns");
  for (const auto& outcome : outcomes) {
    for (const auto& band : outcome.bands)
      fmt::print("{:<24} {:<14} {:>8}\n", outcome.field, band.name,
                 band.columns.size() * outcome.columns_each);
  }
}

void add_planning(cli::App& app, Work& run, const std::string& name, const std::string& what,
                  bool with_search) {
  auto* command = app.add_subcommand(name, what);
  auto arguments = std::make_shared<StudyArguments>();
  arguments->add_to(*command);
  command->callback([&run, arguments, with_search] {
    run = [arguments, with_search] {
      return in_study(*arguments,
                      [&](const study::Settings& settings, const study::Toolbox& tools, Log& log) {
                        study::Study study(arguments->folder, settings, tools, log, base::interrupt_token());
                        print_bands(with_search ? study.search() : study.screen());
                        return 0;
                      });
    };
  });
}

}  // namespace

void add_screen(cli::App& app, Work& run) {
  add_planning(app, run, "screen",
               "build the default network for every column and sort the columns into bands", false);
}

void add_search(cli::App& app, Work& run) {
  add_planning(app, run, "search", "screen, then search the hyperparameters of every submodel", true);
}

}  // namespace elrom::programs
