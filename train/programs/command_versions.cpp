// Versions of a study's model: log, diff, promote, rollback.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/study/version_diff.hpp"
#include "elrom/study/versions.hpp"

namespace elrom::programs {
namespace {

using Json = nlohmann::json;
using std::filesystem::path;

constexpr std::string_view taken_in = "taken in";

Json verdict_of(const study::VersionEvent& event) {
  return event.verdict.empty() ? Json() : Json::parse(event.verdict);
}

std::string shown(const Json& number) {
  return number.is_number() ? base::rounded(number.get<double>()) : "not known";
}

std::string worse_fields(const Json& verdict) {
  if (verdict.is_null()) return "not to be compared with the present one";
  std::vector<std::string> worse;
  for (const auto& field : verdict["fields"])
    if (field["verdict"] == "worse")
      worse.push_back(fmt::format("{} {} -> {}", field["field"].get<std::string>(), shown(field["before"]),
                                  shown(field["after"])));
  if (verdict["verdict"] == "worse") worse.emplace_back("the mean over fields");
  for (const auto& field : verdict.value("missing", Json::array()))
    worse.push_back("no " + field.get<std::string>());
  return base::join(worse, ", ");
}

std::string against(const study::VersionEvent& judged) {
  const auto verdict = verdict_of(judged);
  return (verdict.is_null() ? "" : "worse: ") + worse_fields(verdict);
}

void print_event(const study::VersionEvent& event) {
  fmt::print("{:>4}  {:<9} {:>5} cases  {}", event.number, event.by, event.n_cases,
             event.promoted         ? "answers"
             : event.by == taken_in ? "verdict not known"
                                    : "refused");
  if (event.parent) fmt::print(", after {}", *event.parent);
  if (!event.date.empty()) fmt::print(", {}", event.date);
  if (const auto verdict = verdict_of(event); !verdict.is_null()) {
    fmt::print(", error {} -> {} on {} {}", shown(verdict["before"]), shown(verdict["after"]),
               verdict["cases"].size(), verdict["judged_on"].get<std::string>());
    if (!event.promoted) fmt::print("; worse: {}", worse_fields(verdict));
  } else if (!event.promoted && event.by != taken_in) {
    fmt::print(", {}", worse_fields(verdict));
  }
  fmt::print("\n");
}

int print_log(const path& folder) {
  const study::Versions versions(folder);
  if (versions.has_lost_its_log())
    fmt::print("{}; the versions are {}\n", versions.lost_log_sentence(),
               fmt::join(versions.numbers(), ", "));
  for (const auto& event : versions.log()) print_event(event);
  const auto current = versions.current();
  if (current)
    fmt::print("version {} answers: {}\n", *current, versions.file(*current).string());
  else
    fmt::print("no versions: {} {}\n", folder.string(),
               std::filesystem::exists(folder / "model.elrom") ? "has a model from before there were any"
                                                               : "has no model yet");
  return 0;
}

void expect_study(const path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw InputError({.what = "no such folder", .where = folder.string(), .expected = "a study"});
}

void expect_versions(const path& folder, const study::Versions& versions) {
  if (versions.has_lost_its_log()) make_console_log()->warning(versions.lost_log_sentence());
  if (!versions.current() && !std::filesystem::exists(folder / "model.elrom"))
    throw InputError({.what = "no versions of a model",
                      .where = folder.string(),
                      .advice = "run: elrom-train run " + folder.string()});
}

int promote(const path& folder, int number, const std::string& date) {
  const study::Versions before(folder);
  expect_versions(folder, before);
  if (!study::promote(folder, number, date)) {
    fmt::print("version {} answers already\n", number);
    return 0;
  }
  const auto* judged = before.last_of(number);
  if (judged != nullptr && !judged->promoted && judged->by != taken_in)
    fmt::print("this goes against the gate, which found it {}\n", against(*judged));
  fmt::print("version {} answers now\n", number);
  return 0;
}

int roll_back(const path& folder, const std::string& date) {
  const base::FileLock lock(folder / ".lock");
  study::Versions versions(folder);
  expect_versions(folder, versions);
  versions.settle();
  const auto previous = versions.previous();
  if (!previous)
    throw UsageError({.what = "no version to go back to",
                      .where = folder.string(),
                      .found = fmt::format("version {}, the first that answered", *versions.current())});
  const model::BundleReader bundle(versions.known(*previous));
  bundle.file().verify_all();
  versions.record({.number = *previous, .by = "rollback", .promoted = true, .date = date});
  fmt::print("version {} answers again\n", *previous);
  return 0;
}

struct VersionOptions {
  path folder;
  int a = 0, b = 0;
  std::string date;
};

void add(cli::App& app, Work& run, const std::string& name, const std::string& what,
         const std::vector<std::string>& numbers, bool changes,
         const std::function<int(const VersionOptions&)>& work) {
  auto* command = app.add_subcommand(name, what);
  auto options = std::make_shared<VersionOptions>();
  command->add_option("STUDY", options->folder, "folder of the study")->required();
  for (std::size_t i = 0; i < numbers.size(); ++i)
    command->add_option(numbers[i], i == 0 ? options->a : options->b, "number of a version")->required();
  if (changes) command->add_option("--date", options->date, "kept in the log of versions");
  command->callback([&run, options, work] {
    run = [options, work] {
      expect_study(options->folder);
      return work(*options);
    };
  });
}

}  // namespace

int tell(const study::Promotion& promotion, const path& folder) {
  using Kind = study::Promotion::Kind;
  if (promotion.verdict) fmt::print("{}", in_words(*promotion.verdict));
  if (promotion.kind == Kind::unchanged) {
    fmt::print("version {} answers already: the same model\n", promotion.number);
  } else if (promotion.kind == Kind::refused) {
    fmt::print(
        "not promoted: version {} is kept and does not answer; {}. "
        "elrom-train promote {} {} makes it answer all the same\n",
        promotion.number,
        promotion.verdict ? "worse: " + base::join(promotion.verdict->what_is_worse(), ", ")
                          : "it cannot be compared with the present one",
        folder.string(), promotion.number);
    return static_cast<int>(ExitStatus::refused);
  } else {
    fmt::print("version {} answers{}\n", promotion.number, promotion.kind == Kind::first ? "" : ": promoted");
  }
  return 0;
}

void add_versions(cli::App& app, Work& run) {
  add(app, run, "log", "versions of the study's model: what made each, the gate's verdict, which one answers",
      {}, false, [](const VersionOptions& options) { return print_log(options.folder); });
  add(app, run, "diff", "what is other in version B than in A: cases, settings, methods, errors by field",
      {"A", "B"}, false, [](const VersionOptions& options) {
        const study::Versions versions(options.folder);
        fmt::print("{}", study::in_words(
                             study::difference_of(versions.known(options.a), versions.known(options.b))));
        return 0;
      });
  add(app, run, "promote", "make a version answer, whatever the gate said", {"N"}, true,
      [](const VersionOptions& options) { return promote(options.folder, options.a, options.date); });
  add(app, run, "rollback", "make the version answer that answered before the present one", {}, true,
      [](const VersionOptions& options) { return roll_back(options.folder, options.date); });
}

}  // namespace elrom::programs
