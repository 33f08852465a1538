#include <fmt/format.h>

#include <chrono>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/text.hpp"

namespace elrom::programs {
namespace {

void print_outcomes(const std::vector<study::FieldOutcome>& outcomes) {
  fmt::print("{:<24} {:>10}  {}\n", "field", "NRMSE (cv)", "method");
  double sum = 0;
  for (const auto& outcome : outcomes) {
    fmt::print("{:<24} {:>10}  {}\n", outcome.field, base::rounded(outcome.cross_validated_nrmse, 3),
               outcome.method);
    sum += outcome.cross_validated_nrmse;
  }
  fmt::print("{:<24} {:>10}\n", "mean", base::rounded(sum / static_cast<double>(outcomes.size()), 3));
}

int train(const StudyArguments& arguments, bool with_peers, const study::Settings& settings,
          const study::Toolbox& tools, Log& log) {
  const auto begin = std::chrono::steady_clock::now();
  study::Study study(arguments.folder, settings, tools, log, base::interrupt_token());
  print_outcomes(with_peers ? study.run() : study.fit());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  fmt::print("{} in {}\n", (arguments.folder / "model.elrom").string(), base::duration(seconds));
  return tell(study.promotion(), arguments.folder);
}

void add_training(CLI::App& app, Work& run, const std::string& name, const std::string& what,
                  bool with_peers) {
  auto* command = app.add_subcommand(name, what);
  auto arguments = std::make_shared<StudyArguments>();
  arguments->add_to(*command);
  command->callback([&run, arguments, with_peers] {
    run = [arguments, with_peers] {
      return in_study(*arguments,
                      [&](const study::Settings& settings, const study::Toolbox& tools, Log& log) {
                        return train(*arguments, with_peers, settings, tools, log);
                      });
    };
  });
}

}  // namespace

void add_run(CLI::App& app, Work& run) {
  add_training(
      app, run, "run",
      "every stage: split, screen, band, search, fit, peers; writes model.elrom and peers/.\nA study that has a model gets the new one only through the gate, as with retrain",
      true);
}

void add_fit(CLI::App& app, Work& run) {
  add_training(app, run, "fit",
               "the model without its peers (what it needs of the earlier stages is made first)", false);
}

}  // namespace elrom::programs
