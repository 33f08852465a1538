#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>

#include "commands.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/log.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"

namespace elrom::programs {
namespace {

struct RemoveOptions {
  std::filesystem::path store;
  std::vector<std::string> patterns;
};

/// Cases that any of the patterns matches, in the store's order. @throws InputError for one that matches none
std::vector<std::string> matching(const field::SnapshotStore& store,
                                  const std::vector<std::string>& patterns) {
  std::vector<std::string> all;
  for (const auto& one : store.cases()) all.push_back(one.inputs.name);
  for (const auto& pattern : patterns) {
    if (store.find(pattern).empty())
      throw InputError({.what = "no case matches '" + pattern + "'",
                        .where = store.path().string(),
                        .advice = base::name_advice(pattern, all) + "; nothing was removed"});
  }
  std::vector<std::string> names;
  for (const auto& name : all) {
    const auto is_meant = [&](const std::string& pattern) { return base::matches(name, pattern); };
    if (std::any_of(patterns.begin(), patterns.end(), is_meant)) names.push_back(name);
  }
  return names;
}

/// Those of `names` that the store's furnace description holds out: studies judge on them.
std::vector<std::string> held_out(const field::SnapshotStore& store, const std::vector<std::string>& names) {
  std::vector<std::string> found;
  if (!store.furnace()) return found;
  std::ranges::copy_if(names, std::back_inserter(found), [&](const std::string& name) {
    return std::ranges::any_of(store.furnace()->held_out,
                               [&](const std::string& pattern) { return base::matches(name, pattern); });
  });
  return found;
}

int remove(const RemoveOptions& options) {
  const auto store = field::SnapshotStore::open(options.store);
  const auto names = matching(store, options.patterns);
  const auto n_left = store.n_cases() - names.size();
  if (n_left == 0)
    throw InputError({.what = "no case would be left",
                      .where = options.store.string(),
                      .advice = "remove the file itself; nothing was removed"});
  const auto judges = held_out(store, names);
  field::remove_cases(options.store, {names.begin(), names.end()});
  fmt::print("removed: {}\n{} case{} left in {}\n", base::join(names, ", "), n_left,
             n_left == 1 ? " is" : "s are", options.store.string());
  if (!judges.empty())
    make_console_log()->warning(
        "held out so far, to judge models on: " + base::join(judges, ", ") +
        "; until its next run or retrain a study that held them out is judged on others by "
        "'elrom-report accuracy STUDY --cases NAMES'");
  fmt::print(
      "A study learns without them from its next 'elrom-train retrain' on; a watched folder brings back what "
      "still lies there.\n");
  return 0;
}

}  // namespace

void add_remove(cli::App& program, Work& chosen) {
  auto* command = program.add_subcommand(
      "remove",
      R"(Take cases out of a snapshot store. The store is replaced whole at the end, or stays as it was. To keep a case and
not learn from it, name it in study.toml instead ([train] exclude).)");
  auto options = std::make_shared<RemoveOptions>();
  command->add_option("--store", options->store, "Snapshot store")->type_name("STORE.h5")->required();
  command
      ->add_option("NAME", options->patterns,
                   "Names of cases, or patterns ('train_0*'); each must match a case")
      ->required()
      ->type_name("NAME|PATTERN...");
  command->callback([options, &chosen] { chosen = [options] { return remove(*options); }; });
}

}  // namespace elrom::programs
