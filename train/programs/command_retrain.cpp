#include <fmt/format.h>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/study/retrain.hpp"

namespace elrom::programs {
namespace {

struct RetrainArguments {
  StudyArguments study;
  std::filesystem::path json;
  bool compare = false, small = false;
};

int print(const RetrainArguments& arguments, const study::Settings& settings,
          const study::RetrainReport& report) {
  if (!arguments.json.empty()) base::write_text(arguments.json, study::to_json(report));
  if (report.nothing_new) {
    fmt::print("nothing new: version {} was trained on these {} cases with these settings\n",
               report.promotion.number, report.cases_before);
    return static_cast<int>(ExitStatus::nothing_new);
  }
  if (report.made_before)
    fmt::print("nothing was trained: version {} is of these {} cases and these settings\n",
               report.promotion.number, report.cases_after);
  fmt::print("{} -> {} cases in {}\n", report.cases_before, report.cases_after,
             base::duration(report.seconds));
  if (report.effects) fmt::print("{}", in_words(*report.effects, settings.gate.tolerance / 2));
  return tell(report.promotion, arguments.study.folder);
}

int run_retrain(const RetrainArguments& arguments) {
  if (!arguments.json.empty()) base::expect_writable(arguments.json);
  auto with = arguments.study;
  if (arguments.small) {
    with.effort = "quick";
    with.settings.emplace_back("peers.networks=false");
  }
  return in_study(with, [&](const study::Settings& settings, const study::Toolbox& tools, Log& log) {
    return print(
        arguments, settings,
        study::retrain(with.folder, settings, tools, log, base::interrupt_token(), arguments.compare));
  });
}

}  // namespace

void add_retrain(cli::App& app, Work& run) {
  auto* command = app.add_subcommand(
      "retrain",
      R"(take new cases of the store into an existing study; the new model answers only when no field is
worse beyond scatter. Exit status: 7 it was refused, 8 there is nothing new)");
  auto arguments = std::make_shared<RetrainArguments>();
  arguments->study.add_to(*command);
  command->add_option("--json", arguments->json, "write the figures to this file");
  command->add_flag("--compare", arguments->compare,
                    "also build from nothing, to time it [recorded time of the last full run]");
  command->add_flag("--small", arguments->small,
                    "quick effort without networks: ends within a minute on small stores");
  command->callback([&run, arguments] { run = [arguments] { return run_retrain(*arguments); }; });
}

}  // namespace elrom::programs
