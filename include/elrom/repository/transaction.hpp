#pragma once
// What can be done in one transaction of a repository. All of it is there afterwards, or nothing.
//
// Thread rule: one thread.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/repository/records.hpp"

namespace elrom::repository {

class Connection;

/// There is no such thing.
class NotFoundError : public InputError {
  using InputError::InputError;
};
/// It does not go together with what is there: a name that is taken, a lease that another has, a key used
/// before.
class ConflictError : public InputError {
  using InputError::InputError;
};
/// It was changed since the caller read it.
class StaleError : public InputError {
  using InputError::InputError;
};

/// Part of a list: at most `n` of those whose number is above `after`, ascending.
struct ListPart {
  Id after = 0;
  int n = 100;
};

struct RunFilter {
  std::string model;              ///< empty: any
  std::optional<RunState> state;  ///< nothing: any
  Id scenario = 0;                ///< 0: any
};

/// How a master's work on a run ended.
struct Outcome {
  RunState state = RunState::done;  ///< done, failed, quarantined; waiting: to be tried again
  std::string reason;
  double retry_after_s = 0;           ///< of waiting
  ModelResult result;                 ///< of done: version, verdict, reason, document, fields
  std::vector<std::string> ask = {};  ///< of done: models that are to work on the same inputs next
};

class Transaction {
 public:
  /// A run whose lease ended this often without an answer is quarantined: it kills its masters.
  static constexpr int most_attempts = 5;

  /// @param now seconds since 1970
  Transaction(Connection& connection, double now) : connection_(connection), now_(now) {}
  [[nodiscard]] double now() const { return now_; }
  /// Whether any run was changed: claim() may change one and give out none.
  [[nodiscard]] bool changed_runs() const { return changed_runs_; }

  // Scenarios. The caller fills in what a person tells; number, revision and time are made here.
  Scenario add(Scenario scenario);  ///< @throws ConflictError for a name that is taken
  /// @param revision that the caller read @throws StaleError when it is not the present one
  Scenario change(Scenario scenario, std::int64_t revision);
  [[nodiscard]] Scenario scenario(Id id);  ///< @throws NotFoundError
  [[nodiscard]] std::vector<Scenario> scenarios(const ListPart& part);

  // Runs.
  /// @throws NotFoundError for a scenario or a source that is not there
  Run add_run(Id scenario, const std::string& model, const std::vector<Id>& sources, const std::string& by);
  /// Gives out the oldest run of a model that waits or whose lease is over. Nothing: there is none.
  std::optional<Run> claim(const std::string& model, const std::string& worker, double lease_s);
  /// @throws ConflictError when the lease is not (or no longer) the run's
  Run renew(Id run, const std::string& lease, double lease_s);
  /// Models that the outcome asks for get a run that builds on the result, unless one of the same inputs
  /// waits, runs or is done: that one then builds on it too.
  Run give_back(Id run, const std::string& lease, const Outcome& outcome);
  [[nodiscard]] Run run(Id id);
  [[nodiscard]] std::vector<Run> runs(const RunFilter& filter, const ListPart& part);

  // Results.
  [[nodiscard]] ModelResult result(Id id);
  [[nodiscard]] ModelResult result_of(Id run);
  [[nodiscard]] std::vector<ModelResult> results(Id scenario, const ListPart& part);
  [[nodiscard]] std::string inputs(const std::string& digest);

  // Fields: their file is in place before they are known here.
  void know(const StoredFields& fields);
  [[nodiscard]] std::optional<StoredFields> fields(const std::string& digest);

  // Quarantine.
  Quarantined quarantine(Quarantined what);
  [[nodiscard]] Quarantined quarantined(Id id);
  [[nodiscard]] std::vector<Quarantined> quarantine_list(const ListPart& part);

  // Tokens.
  /// @return the secret, which is not kept @throws ConflictError for a name that is taken
  std::string make_token(const std::string& name, Role role);
  void remove_token(const std::string& name);
  [[nodiscard]] std::vector<Token> tokens();
  /// Whose secret it is. Takes as long for a wrong one.
  [[nodiscard]] std::optional<Token> token_of(const std::string& secret);

  /// Numbers of rows: "scenarios", "results", "quarantined", "runs_waiting" ...
  [[nodiscard]] std::map<std::string, std::int64_t> counts();

 private:
  void expect_change(Id scenario, std::int64_t revision);
  void keep_inputs(const Scenario& scenario);
  void update(Run& run);
  Run leased(Id run, const std::string& lease);
  Id insert_run(const Run& run);
  void follow(Id run, Id source);
  Id keep_result(const Run& run, ModelResult result);
  void ask(const std::string& model, const Run& after, Id result);

  Connection& connection_;
  double now_;
  bool changed_runs_ = false;
};

}  // namespace elrom::repository
