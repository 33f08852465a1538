#include "elrom/ingest/import_checked.hpp"

#include <set>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/error.hpp"

namespace elrom::ingest {
namespace {

constexpr base::EnumNames<Policy, 3> policies{
    "policy", {{Policy::refuse, "refuse"}, {Policy::drop, "drop"}, {Policy::keep, "keep"}}};

/// Thrown through import_cases() to leave the store alone and begin again without some cases.
struct WithoutThem {
  std::set<std::string> names;
};

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

  /// Judges the new cases. @throws InputError, WithoutThem
  void confirm() const {
    const auto findings = checker_.findings();
    WithoutThem dropped;
    for (std::size_t i = n_old_; i < checker_.cases().size(); ++i) {
      const auto& name = checker_.cases()[i].name;
      for (const auto& finding : findings_on(findings, name)) {
        if (finding.severity == Severity::wrong)
          settle(finding, dropped);
        else
          log_.warning(line_of(finding));
      }
    }
    if (!dropped.names.empty()) throw dropped;
  }

 private:
  void settle(const Finding& finding, WithoutThem& dropped) const {
    if (policy_ == Policy::refuse) {
      throw InputError(
          Problem{.what = line_of(finding),
                  .advice = "correct the case, or say --on-suspicious drop or keep; nothing was added"});
    }
    log_.warning(line_of(finding) + (policy_ == Policy::drop ? "; left out" : "; kept as asked"));
    if (policy_ == Policy::drop) dropped.names.insert(finding.case_name);
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
  std::set<std::string> left_out;
  // Without the dropped cases the others look different; a round that drops nothing ends it.
  for (;;) {
    Gate gate(options, policy, log);
    auto checked = options;
    checked.accept = [&](const CfdCase& one) {
      if (left_out.contains(one.record.inputs.name)) return false;
      return !options.accept || options.accept(one);
    };
    checked.watch = [&](const field::Snapshot& snapshot, const field::Mesh& mesh,
                        const field::InputSchema& schema, std::span<const field::FieldInfo> fields) {
      gate.add(snapshot, mesh, schema, fields);
    };
    checked.confirm = [&] { gate.confirm(); };
    try {
      return import_cases(checked, log, stop);
    } catch (const WithoutThem& dropped) {
      left_out.insert(dropped.names.begin(), dropped.names.end());
    }
  }
}

}  // namespace elrom::ingest
