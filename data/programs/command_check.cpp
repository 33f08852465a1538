#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "commands.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/ingest/check.hpp"

namespace elrom::programs {
namespace {

struct Options {
  std::vector<std::string> targets;
  std::string json;
};

/// Adds the targets one by one; what cannot be read becomes a
/// finding, so that one bad file does not hide the others.
void add_targets(const Options& options, ingest::Checker& checker) {
  for (const auto& target : options.targets) {
    try {
      if (ingest::is_snapshot_store(target)) {
        checker.add(field::SnapshotStore::open(target));
      } else {
        checker.add(ingest::view_of(ingest::read_case(target)));
      }
    } catch (const InputError& error) {
      checker.add_unreadable(target, error.what());
    }
  }
}

int check(const Options& options) {
  ingest::Checker checker;
  add_targets(options, checker);
  const auto findings = checker.findings();
  std::size_t n_serious = 0;
  for (const auto& finding : findings) {
    fmt::print("{}\n", ingest::line_of(finding));
    if (finding.severity != ingest::Severity::note) ++n_serious;
  }
  if (!options.json.empty()) base::write_text(options.json, to_json(checker, findings));
  fmt::print("{} case{} checked: {}\n", checker.cases().size(), checker.cases().size() == 1 ? "" : "s",
             n_serious == 0 ? "nothing suspicious"
                            : fmt::format("{} finding{}", n_serious, n_serious == 1 ? "" : "s"));
  return static_cast<int>(n_serious == 0 ? ExitStatus::ok : ExitStatus::input);
}

}  // namespace

void add_check(CLI::App& program, Work& chosen) {
  auto* command = program.add_subcommand(
      "check",
      R"(Looks for suspicious data: cells that are not finite or beyond physical bounds, unit mistakes, duplicate cases,
cases that lie apart from the others, fields and inputs that never change. Cases are compared with each other, so give
the store (or all files) together with a new file. Exit status 3 when something is suspicious.)");
  auto options = std::make_shared<Options>();
  command
      ->add_option("targets", options->targets,
                   "A snapshot store, EL3D exports, Fluent tables, OpenFOAM cases")
      ->required()
      ->type_name("STORE|FILE...");
  command->add_option("--json", options->json, "Write the findings to this file too")->type_name("FILE");
  command->callback([options, &chosen] { chosen = [options] { return check(*options); }; });
}

}  // namespace elrom::programs
