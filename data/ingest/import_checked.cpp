#include "elrom/ingest/import_checked.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::ingest {
namespace {

constexpr base::EnumNames<Policy, 3> policies{
    "policy", {{Policy::refuse, "refuse"}, {Policy::drop, "drop"}, {Policy::keep, "keep"}}};

class Gate {
 public:
  Gate(const ImportOptions& options, const Judgement& judgement, Log& log)
      : options_(options), judgement_(judgement), log_(log) {
    if (std::filesystem::exists(options.store)) checker_.add(field::SnapshotStore::open(options.store));
    n_old_ = checker_.cases().size();
  }

  void add(const EnteringCase& one) {
    checker_.add(view_of(one.snapshot.record, one.snapshot.fields, one.mesh, one.schema, one.fields,
                         one.furnace, one.coverage));
    files_[one.snapshot.record.inputs.name] = one.file;
  }

  /// Judges the new cases: names of those that are not to stay. @throws InputError
  std::set<std::string> judge() {
    std::set<std::string> dropped;
    // Without the dropped cases the others look different; a round that drops nothing ends it.
    for (;;) {
      const auto findings = on_new_cases();
      const auto standing = worst_of(findings);
      if (!standing.empty() && judgement_.policy == Policy::refuse) refuse(standing);
      if (standing.empty() || judgement_.policy == Policy::keep) {
        for (const auto& finding : findings) log_.warning(line_of(finding) + "; kept as asked");
        return dropped;
      }
      for (const auto& finding : standing) drop(finding, dropped);
      checker_.forget(dropped);
    }
  }

 private:
  [[nodiscard]] std::vector<Finding> on_new_cases() const {
    const auto all = checker_.findings();
    std::vector<Finding> found;
    for (std::size_t i = n_old_; i < checker_.cases().size(); ++i)
      for (auto& finding : findings_on(all, checker_.cases()[i].name)) found.push_back(std::move(finding));
    return found;
  }

  /// What is wrong; where nothing is, what is suspicious: a wrong case may cast suspicion on others.
  [[nodiscard]] std::vector<Finding> worst_of(const std::vector<Finding>& findings) const {
    std::vector<Finding> standing;
    for (const auto& finding : findings)
      if (!judgement_.accepted.contains(finding.kind)) standing.push_back(finding);
    const auto is_wrong = [](const Finding& finding) { return finding.severity == Severity::wrong; };
    if (std::any_of(standing.begin(), standing.end(), is_wrong))
      std::erase_if(standing, [&](const Finding& finding) { return !is_wrong(finding); });
    return standing;
  }

  [[noreturn]] void refuse(const std::vector<Finding>& standing) const {
    for (std::size_t i = 1; i < standing.size(); ++i) log_.warning(line_of(standing[i]));
    throw InputError(Problem{.what = line_of(standing.front()),
                             .advice = "correct the case, or take it as it is by --accept " +
                                       standing.front().kind +
                                       " or --on-suspicious keep, or leave it out by --on-suspicious drop; "
                                       "nothing was added"});
  }

  void drop(const Finding& finding, std::set<std::string>& dropped) const {
    log_.warning(line_of(finding) + "; left out");
    const bool is_first = dropped.insert(finding.case_name).second;
    if (is_first && options_.refused)
      options_.refused(files_.at(finding.case_name),
                       line_of(finding) + "; --accept " + finding.kind + " would take it as it is");
  }

  const ImportOptions& options_;
  const Judgement& judgement_;
  Log& log_;
  Checker checker_;
  std::size_t n_old_ = 0;
  std::map<std::string, std::filesystem::path> files_;  //!< of new cases, by name
};

}  // namespace

Policy policy_of(std::string_view name) { return policies.value<UsageError>(name); }

std::set<std::string> accepted_kinds(const std::vector<std::string>& names) {
  const auto& kinds = finding_kinds();
  for (const auto& name : names) {
    if (std::find(kinds.begin(), kinds.end(), name) != kinds.end()) continue;
    throw UsageError({.what = "no check is called '" + name + "'",
                      .expected = base::join(kinds, ", "),
                      .advice = base::name_advice(name, kinds)});
  }
  return {names.begin(), names.end()};
}

ImportSummary import_checked(const ImportOptions& options, const Judgement& judgement, Log& log,
                             const std::stop_token& stop) {
  Gate gate(options, judgement, log);
  auto checked = options;
  checked.watch = [&](const EnteringCase& one) { gate.add(one); };
  checked.leave_out = [&] { return gate.judge(); };
  return import_cases(checked, log, stop);
}

}  // namespace elrom::ingest
