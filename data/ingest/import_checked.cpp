#include "elrom/ingest/import_checked.hpp"

#include <set>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"

namespace elrom::ingest {
namespace {

constexpr base::EnumNames<Policy, 3> policies{
    "policy", {{Policy::refuse, "refuse"}, {Policy::drop, "drop"}, {Policy::keep, "keep"}}};

class Gate {
 public:
  Gate(const ImportOptions& options, Policy policy, Log& log) : policy_(policy), log_(log) {
    if (std::filesystem::exists(options.store)) checker_.add(field::SnapshotStore::open(options.store));
    n_old_ = checker_.cases().size();
  }

  void add(const field::Snapshot& snapshot, const field::Mesh& mesh, const field::InputSchema& schema,
           std::span<const field::FieldInfo> fields) {
    checker_.add(view_of(snapshot.record, snapshot.fields, mesh, schema, fields));
  }

  /// Judges the new cases: names of those that are not to stay. @throws InputError
  std::set<std::string> judge() {
    std::set<std::string> dropped;
    // Without the dropped cases the others look different; a round that drops nothing ends it.
    for (;;) {
      const auto findings = on_new_cases();
      const auto n_before = dropped.size();
      for (const auto& finding : findings)
        if (finding.severity == Severity::wrong) settle(finding, dropped);
      if (dropped.size() > n_before) {
        checker_.forget(dropped);
        continue;
      }
      for (const auto& finding : findings)
        if (finding.severity != Severity::wrong) log_.warning(line_of(finding));
      return dropped;
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

  void settle(const Finding& finding, std::set<std::string>& dropped) const {
    if (policy_ == Policy::refuse) {
      throw InputError(
          Problem{.what = line_of(finding),
                  .advice = "correct the case, or say --on-suspicious drop or keep; nothing was added"});
    }
    log_.warning(line_of(finding) + (policy_ == Policy::drop ? "; left out" : "; kept as asked"));
    if (policy_ == Policy::drop) dropped.insert(finding.case_name);
  }

  Policy policy_;
  Log& log_;
  Checker checker_;
  std::size_t n_old_ = 0;
};

}  // namespace

Policy policy_of(std::string_view name) { return policies.value<UsageError>(name); }

ImportSummary import_checked(const ImportOptions& options, Policy policy, Log& log,
                             const std::stop_token& stop) {
  Gate gate(options, policy, log);
  auto checked = options;
  checked.watch = [&](const field::Snapshot& snapshot, const field::Mesh& mesh,
                      const field::InputSchema& schema,
                      std::span<const field::FieldInfo> fields) { gate.add(snapshot, mesh, schema, fields); };
  checked.leave_out = [&] { return gate.judge(); };
  return import_cases(checked, log, stop);
}

}  // namespace elrom::ingest
