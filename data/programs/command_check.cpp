#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <set>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/cases_table.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/ingest/check.hpp"
#include "elrom/ingest/onto_mesh.hpp"

namespace elrom::programs {
namespace {

struct CheckOptions {
  std::vector<std::string> targets;
  std::filesystem::path furnace, cases;
  std::string json;
};

/// Adds the targets one by one; what cannot be read becomes a finding, so that one bad file does not hide the
/// others. Files beside a store are brought to its mesh, as import would.
class Targets {
 public:
  Targets(const CheckOptions& options, ingest::Checker& checker) : checker_(checker) {
    if (!options.furnace.empty()) furnace_ = field::read_furnace(options.furnace);
    if (!options.cases.empty()) table_ = ingest::read_cases_table(options.cases);
  }

  void add(const std::vector<std::string>& targets) {
    const auto is_store = [](const std::string& target) {
      return std::filesystem::exists(target) && ingest::is_snapshot_store(target);
    };
    for (const auto& target : targets)
      attempt(target, [&] {
        if (is_store(target)) add_store(target);
      });
    for (const auto& target : targets)
      attempt(target, [&] {
        if (!is_store(target)) add_file(target);
      });
  }

 private:
  template <class Work>
  void attempt(const std::string& target, Work work) {
    try {
      work();
    } catch (const InputError& error) {
      if (told_.insert(target).second) checker_.add_unreadable(target, error.what());
    }
  }

  void add_store(const std::string& target) {
    stores_.push_back(field::SnapshotStore::open(target));
    checker_.add(stores_.back());
    if (stores_.size() > 1) return;
    if (!furnace_) furnace_ = stores_[0].furnace();
    onto_mesh_.emplace(stores_[0].mesh(), base::available_threads(), base::interrupt_token());
  }

  void add_file(const std::string& target) {
    auto one = ingest::read_case(target);
    if (table_) ingest::complete_inputs(one, *table_);
    const auto* furnace = furnace_ ? &*furnace_ : nullptr;
    if (!onto_mesh_) {
      const auto layers = ingest::layers_of(one);
      checker_.add(ingest::view_of(one, layers ? &*layers : nullptr, furnace));
      return;
    }
    const auto& store = stores_[0];
    const auto snapshot = onto_mesh_->bring(one, store.schema(), store.fields());
    checker_.add(ingest::view_of(snapshot.record, snapshot.fields, store.mesh(), store.schema(),
                                 store.fields(), furnace, onto_mesh_->coverage()));
  }

  ingest::Checker& checker_;
  std::optional<field::Furnace> furnace_;
  std::optional<ingest::CasesTable> table_;
  std::deque<field::SnapshotStore> stores_;
  std::optional<ingest::OntoMesh> onto_mesh_;  //!< of the first store
  std::set<std::string> told_;
};

int check(const CheckOptions& options) {
  if (!options.json.empty()) base::expect_writable(options.json);
  ingest::Checker checker;
  Targets(options, checker).add(options.targets);
  const auto findings = checker.findings();
  std::size_t n_serious = 0;
  std::set<std::string> kinds;
  for (const auto& finding : findings) {
    fmt::print("{}\n", ingest::line_of(finding));
    if (finding.severity == ingest::Severity::note) continue;
    ++n_serious;
    const auto& known = ingest::finding_kinds();
    if (std::find(known.begin(), known.end(), finding.kind) != known.end()) kinds.insert(finding.kind);
  }
  if (!options.json.empty()) base::write_text(options.json, to_json(checker, findings));
  fmt::print("{} case{} checked: {}\n", checker.cases().size(), checker.cases().size() == 1 ? "" : "s",
             n_serious == 0 ? "nothing suspicious"
                            : fmt::format("{} finding{}", n_serious, n_serious == 1 ? "" : "s"));
  if (!kinds.empty())
    fmt::print("Import takes such cases as they are by --accept {}\n",
               base::join({kinds.begin(), kinds.end()}, ","));
  return static_cast<int>(n_serious == 0 ? ExitStatus::ok : ExitStatus::input);
}

}  // namespace

void add_check(cli::App& program, Work& chosen) {
  auto* command = program.add_subcommand(
      "check",
      R"(Looks for suspicious data: cells that are not finite or beyond physical bounds, unit mistakes, duplicate cases,
cases that lie apart from the others, fields that are empty or copies of another, fields and inputs that never change,
and physics: continuity and balance of the gas, direction of flow, solids inventory and the pressure that carries it,
roughness, and whether the mesh fills the reduced one. Cases are compared with each other, so give the store (or all
files) together with a new file. Exit status 3 when something is suspicious. data/FORMATS.md lists all limits.)");
  auto options = std::make_shared<CheckOptions>();
  command
      ->add_option("targets", options->targets,
                   "A snapshot store, EL3D exports, Fluent tables, OpenFOAM cases")
      ->required()
      ->type_name("STORE|FILE...");
  command
      ->add_option("--furnace", options->furnace,
                   "Furnace description, for balances [default: the store's, where one is given]")
      ->type_name("FURNACE.toml");
  command
      ->add_option("--cases", options->cases,
                   "Table of boundary conditions, for formats that carry none; cases are found by name")
      ->type_name("CASES.csv");
  command->add_option("--json", options->json, "Write the findings to this file too")->type_name("FILE");
  command->callback([options, &chosen] { chosen = [options] { return check(*options); }; });
}

}  // namespace elrom::programs
