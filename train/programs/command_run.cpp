#include <fmt/format.h>

#include <limits>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/study/budget.hpp"

namespace elrom::programs {
namespace {

double seconds_of(const std::string& budget) {
  double seconds = 0;
  try {
    seconds = base::quantity(budget, "s");
  } catch (const InputError&) {  // told below, with what is expected here
  }
  if (!(seconds > 0))
    throw UsageError({.what = "no time to train in --budget",
                      .found = "'" + budget + "'",
                      .expected = "one number and its unit, such as 90s, 10min or 1.5h"});
  return seconds;
}

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
          const study::Toolbox& tools, Log& log, const std::stop_token& stop = base::interrupt_token()) {
  const base::Stopwatch watch;
  study::Study study(arguments.folder, settings, tools, log, stop);
  print_outcomes(with_peers ? study.run() : study.fit());
  const double seconds = watch.seconds();
  fmt::print("{} in {}\n", (arguments.folder / "model.elrom").string(), base::duration(seconds));
  return tell(study.promotion(), arguments.folder);
}

int train_within(double seconds, const StudyArguments& arguments, bool with_peers,
                 const study::Settings& settings, const study::Toolbox& tools, Log& all) {
  const base::Stopwatch watch;
  const auto once = warn_once(all);  // every level opens the study anew
  Log& log = *once;
  const auto model = study::cost_model(arguments.folder, settings, log);
  const auto levels = study::budget_levels(settings, model);
  const auto resolved = arguments.folder / "resolved.toml";
  int status = std::numeric_limits<int>::max();
  const double taken = watch.seconds();
  const auto spent = study::run_within(
      seconds - taken, levels, log, base::interrupt_token(),
      [&](const study::Settings& own, const std::stop_token& stop) {
        const auto before = std::filesystem::exists(resolved) ? base::read_text(resolved) : "";
        try {
          status = std::min(status, train(arguments, with_peers, own, tools, log, stop));
        } catch (const Interrupted&) {
          if (!before.empty()) base::write_text(resolved, before);  // those of the model that stands
          throw;
        }
      });
  for (const auto& sentence : study::left_out(levels, spent)) fmt::print("{}\n", sentence);
  fmt::print("{} of {}; the settings used are in {}\n", base::duration(watch.seconds()),
             base::duration(seconds), resolved.string());
  return status;
}

void add_training(cli::App& app, Work& run, const std::string& name, const std::string& what,
                  bool with_peers) {
  auto* command = app.add_subcommand(name, what);
  auto arguments = std::make_shared<StudyArguments>();
  auto budget = std::make_shared<std::string>();
  arguments->add_to(*command);
  command->add_option(
      "--budget", *budget,
      "time to spend at most, \"10min\": what buys most is done first, the rest is left out and named");
  command->callback([&run, arguments, budget, with_peers] {
    run = [arguments, budget, with_peers] {
      const auto seconds = budget->empty() ? 0.0 : seconds_of(*budget);
      return in_study(*arguments,
                      [&](const study::Settings& settings, const study::Toolbox& tools, Log& log) {
                        if (seconds > 0)
                          return train_within(seconds, *arguments, with_peers, settings, tools, log);
                        return train(*arguments, with_peers, settings, tools, log);
                      });
    };
  });
}

}  // namespace

void add_run(cli::App& app, Work& run) {
  add_training(
      app, run, "run",
      "every stage: split, screen, band, search, fit, peers; writes model.elrom and peers/.\nA study that has a model gets the new one only through the gate, as with retrain",
      true);
}

void add_fit(cli::App& app, Work& run) {
  add_training(app, run, "fit",
               "the model without its peers (what it needs of the earlier stages is made first)", false);
}

}  // namespace elrom::programs
