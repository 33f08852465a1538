#include "elrom/repository/transaction.hpp"

#include <span>

#include "database.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/repository/secret.hpp"

namespace elrom::repository {
namespace {

constexpr const char* scenario_columns =
    "s.id, s.revision, s.name, s.boiler, s.note, s.load, s.inputs, i.document, s.verdict, s.reason, s.by, s.at";
constexpr const char* run_columns =
    "id, revision, scenario, inputs, model, state, worker, lease, lease_until, not_before, attempts, reason, by, "
    "at";
constexpr const char* result_columns =
    "id, run, scenario, inputs, model, version, verdict, reason, document, fields, at";

Scenario scenario_in(const DbRows& row) {
  return {.id = row.integer(0),
          .revision = row.integer(1),
          .name = row.text(2),
          .boiler = row.text(3),
          .note = row.text(4),
          .load = row.real(5),
          .inputs = row.text(7),
          .inputs_digest = row.text(6),
          .verdict = row.text(8),
          .reason = row.text(9),
          .by = row.text(10),
          .at = row.real(11)};
}

Run run_in(const DbRows& row) {
  return {.id = row.integer(0),
          .revision = row.integer(1),
          .scenario = row.integer(2),
          .inputs_digest = row.text(3),
          .model = row.text(4),
          .state = run_states.value(row.text(5)),
          .worker = row.text(6),
          .lease = row.text(7),
          .lease_until = row.real(8),
          .not_before = row.real(9),
          .attempts = static_cast<int>(row.integer(10)),
          .reason = row.text(11),
          .sources = {},
          .by = row.text(12),
          .at = row.real(13)};
}

ModelResult result_in(const DbRows& row) {
  return {.id = row.integer(0),
          .run = row.integer(1),
          .scenario = row.integer(2),
          .inputs_digest = row.text(3),
          .model = row.text(4),
          .version = row.text(5),
          .verdict = row.text(6),
          .reason = row.text(7),
          .document = row.text(8),
          .fields = row.text(9),
          .at = row.real(10)};
}

Quarantined quarantined_in(const DbRows& row) {
  return {.id = row.integer(0),
          .kind = row.text(1),
          .document = row.text(2),
          .reason = row.text(3),
          .by = row.text(4),
          .at = row.real(5)};
}

std::string name_of(RunState state) { return std::string(run_states.name(state)); }

[[noreturn]] void not_found(const std::string& what, Id id) {
  throw NotFoundError(Problem{.what = "no " + what + " " + std::to_string(id)});
}

std::vector<Id> sources_of(Id run, Connection& connection) {
  return list_of(connection.query("SELECT source FROM lineage WHERE run = $1 ORDER BY source", {run}),
                 [](const DbRows& row) { return row.integer(0); });
}

std::vector<ModelResult> results_where(const std::string& condition, const DbValues& values,
                                       Connection& connection) {
  auto found = list_of(
      connection.query("SELECT " + std::string(result_columns) + " FROM results WHERE " + condition, values),
      result_in);
  for (auto& one : found)
    one.followed_by =
        list_of(connection.query("SELECT run FROM lineage WHERE source = $1 ORDER BY run", {one.id}),
                [](const DbRows& row) { return row.integer(0); });
  return found;
}

}  // namespace

// Scenarios

void Transaction::keep_inputs(const Scenario& scenario) {
  connection_.query("INSERT INTO inputs VALUES ($1, $2) ON CONFLICT DO NOTHING",
                    {scenario.inputs_digest, scenario.inputs});
}

Scenario Transaction::add(Scenario scenario) {
  scenario.inputs_digest = base::sha256(std::as_bytes(std::span(scenario.inputs)));
  keep_inputs(scenario);
  const auto row = connection_.query(
      "INSERT INTO scenarios (revision, name, boiler, note, load, inputs, verdict, reason, by, at) "
      "VALUES (1, $1, $2, $3, $4, $5, $6, $7, $8, $9) ON CONFLICT DO NOTHING RETURNING id",
      {scenario.name, scenario.boiler, scenario.note, scenario.load, scenario.inputs_digest, scenario.verdict,
       scenario.reason, scenario.by, now_});
  if (!row->next())
    throw ConflictError(Problem{.what = "a scenario of that name is there already",
                                .found = "'" + scenario.name + "'",
                                .advice = "choose another name, or change that one"});
  return this->scenario(row->integer(0));
}

Scenario Transaction::change(Scenario scenario, std::int64_t revision) {
  expect_change(scenario.id, revision);
  scenario.inputs_digest = base::sha256(std::as_bytes(std::span(scenario.inputs)));
  keep_inputs(scenario);
  const auto taken = connection_.query("SELECT id FROM scenarios WHERE name = $1 AND id <> $2",
                                       {scenario.name, scenario.id});
  if (taken->next())
    throw ConflictError(
        Problem{.what = "a scenario of that name is there already", .found = "'" + scenario.name + "'"});
  connection_.query(
      "UPDATE scenarios SET revision = revision + 1, name = $1, boiler = $2, note = $3, load = $4, inputs = $5, "
      "verdict = $6, reason = $7, by = $8, at = $9 WHERE id = $10",
      {scenario.name, scenario.boiler, scenario.note, scenario.load, scenario.inputs_digest, scenario.verdict,
       scenario.reason, scenario.by, now_, scenario.id});
  return this->scenario(scenario.id);
}

void Transaction::expect_change(Id id, std::int64_t revision) {
  const auto present = scenario(id).revision;
  if (present == revision) return;
  throw StaleError(Problem{.what = "the scenario was changed since it was read",
                           .where = "scenario " + std::to_string(id),
                           .found = "revision " + std::to_string(revision),
                           .expected = std::to_string(present),
                           .advice = "read it again"});
}

Scenario Transaction::scenario(Id id) {
  const auto row =
      connection_.query("SELECT " + std::string(scenario_columns) +
                            " FROM scenarios s JOIN inputs i ON i.digest = s.inputs WHERE s.id = $1",
                        {id});
  if (!row->next()) not_found("scenario", id);
  return scenario_in(*row);
}

std::vector<Scenario> Transaction::scenarios(const ListPart& part) {
  return list_of(
      connection_.query("SELECT " + std::string(scenario_columns) +
                            " FROM scenarios s JOIN inputs i ON i.digest = s.inputs WHERE s.id > $1 "
                            "ORDER BY s.id LIMIT $2",
                        {part.after, std::int64_t{part.n}}),
      scenario_in);
}

std::string Transaction::inputs(const std::string& digest) {
  const auto row = connection_.query("SELECT document FROM inputs WHERE digest = $1", {digest});
  if (!row->next()) throw NotFoundError(Problem{.what = "no such inputs", .found = "'" + digest + "'"});
  return row->text(0);
}

// Runs

Run Transaction::add_run(Id scenario_id, const std::string& model, const std::vector<Id>& sources,
                         const std::string& by) {
  const auto of = scenario(scenario_id);
  const Id id = insert_run({.scenario = of.id, .inputs_digest = of.inputs_digest, .model = model, .by = by});
  for (const Id source : sources) {
    (void)result(source);
    follow(id, source);
  }
  return run(id);
}

Id Transaction::insert_run(const Run& run) {
  const auto row = connection_.query(
      "INSERT INTO runs (revision, scenario, inputs, model, state, worker, lease, lease_until, not_before, "
      "attempts, reason, by, at) VALUES (1, $1, $2, $3, 'waiting', '', '', 0, 0, 0, '', $4, $5) RETURNING id",
      {run.scenario, run.inputs_digest, run.model, run.by, now_});
  row->next();
  return row->integer(0);
}

void Transaction::follow(Id run, Id source) {
  connection_.query("INSERT INTO lineage VALUES ($1, $2) ON CONFLICT DO NOTHING", {run, source});
}

Run Transaction::run(Id id) {
  const auto row = connection_.query("SELECT " + std::string(run_columns) + " FROM runs WHERE id = $1", {id});
  if (!row->next()) not_found("run", id);
  auto found = run_in(*row);
  found.sources = sources_of(id, connection_);
  return found;
}

std::vector<Run> Transaction::runs(const RunFilter& filter, const ListPart& part) {
  std::string sql = "SELECT " + std::string(run_columns) + " FROM runs WHERE id > $1";
  DbValues values{part.after};
  const auto where = [&](const char* column, DbValue value) {
    values.push_back(std::move(value));
    sql += " AND " + std::string(column) + " = $" + std::to_string(values.size());
  };
  if (!filter.model.empty()) where("model", filter.model);
  if (filter.state) where("state", name_of(*filter.state));
  if (filter.scenario != 0) where("scenario", filter.scenario);
  values.emplace_back(std::int64_t{part.n});
  auto found = list_of(
      connection_.query(sql + " ORDER BY id LIMIT $" + std::to_string(values.size()), values), run_in);
  for (auto& run : found) run.sources = sources_of(run.id, connection_);
  return found;
}

/// All but its number and what it is of. Nobody else has changed it: it was read in this transaction.
void Transaction::update(Run& run) {
  ++run.revision;
  changed_runs_ = true;
  connection_.query(
      "UPDATE runs SET revision = $1, state = $2, worker = $3, lease = $4, lease_until = $5, not_before = $6, "
      "attempts = $7, reason = $8 WHERE id = $9",
      {run.revision, name_of(run.state), run.worker, run.lease, run.lease_until, run.not_before,
       std::int64_t{run.attempts}, run.reason, run.id});
}

std::optional<Run> Transaction::claim(const std::string& model, const std::string& worker, double lease_s) {
  for (;;) {
    const auto row = connection_.query(
        "SELECT id FROM runs WHERE model = $1 AND ((state = 'waiting' AND not_before <= $2) OR "
        "(state = 'running' AND lease_until < $2)) ORDER BY id LIMIT 1",
        {model, now_});
    if (!row->next()) return std::nullopt;
    auto found = run(row->integer(0));
    if (found.attempts < most_attempts) {
      found.state = RunState::running;
      found.worker = worker;
      found.lease = random_secret();
      found.lease_until = now_ + lease_s;
      ++found.attempts;
      update(found);
      return found;
    }
    found.state = RunState::quarantined;
    found.reason =
        std::to_string(most_attempts) + " masters began it and none came back; last " + found.worker;
    found.lease.clear();
    update(found);
  }
}

Run Transaction::leased(Id id, const std::string& lease) {
  auto found = run(id);
  if (found.state == RunState::running && same_in_constant_time(found.lease, lease)) return found;
  throw ConflictError(
      Problem{.what = "the run is not yours",
              .where = "run " + std::to_string(id),
              .found = found.state == RunState::running ? "another lease" : name_of(found.state),
              .advice = "claim another; the lease ended before it was renewed"});
}

Run Transaction::renew(Id id, const std::string& lease, double lease_s) {
  auto found = leased(id, lease);
  found.lease_until = now_ + lease_s;
  update(found);
  return found;
}

Run Transaction::give_back(Id id, const std::string& lease, const Outcome& outcome) {
  if (outcome.state == RunState::running) throw UsageError("a run that is given back is not running");
  auto found = leased(id, lease);
  if (outcome.state == RunState::done) {
    const Id result = keep_result(found, outcome.result);
    for (const auto& model : outcome.ask) ask(model, found, result);
  }
  found.state = outcome.state;
  found.reason = outcome.reason;
  found.lease.clear();
  found.lease_until = 0;
  found.not_before = outcome.state == RunState::waiting ? now_ + outcome.retry_after_s : 0;
  // Whoever comes back with a reason is not killed by the run; but it is not tried for ever.
  if (found.state == RunState::waiting && found.attempts >= most_attempts) found.state = RunState::failed;
  update(found);
  return found;
}

// Results

Id Transaction::keep_result(const Run& run, ModelResult result) {
  if (!result.fields.empty() && !fields(result.fields))
    throw InputError(Problem{.what = "fields that are not here",
                             .found = "'" + result.fields + "'",
                             .advice = "send them before the result"});
  const auto row = connection_.query(
      "INSERT INTO results (run, scenario, inputs, model, version, verdict, reason, document, fields, at) "
      "VALUES ($1, $2, $3, $4, $5, $6, $7, $8, $9, $10) RETURNING id",
      {run.id, run.scenario, run.inputs_digest, run.model, result.version, result.verdict, result.reason,
       result.document, result.fields, now_});
  row->next();
  return row->integer(0);
}

/// A run may cost a day: the same inputs are not simulated twice.
void Transaction::ask(const std::string& model, const Run& after, Id result) {
  const auto there = connection_.query(
      "SELECT id FROM runs WHERE model = $1 AND inputs = $2 AND state IN ('waiting', 'running', 'done') "
      "ORDER BY id LIMIT 1",
      {model, after.inputs_digest});
  const Id id = there->next() ? there->integer(0)
                              : insert_run({.scenario = after.scenario,
                                            .inputs_digest = after.inputs_digest,
                                            .model = model,
                                            .by = after.by});
  follow(id, result);
}

ModelResult Transaction::result(Id id) {
  auto found = results_where("id = $1", {id}, connection_);
  if (found.empty()) not_found("result", id);
  return std::move(found.front());
}

ModelResult Transaction::result_of(Id run) {
  auto found = results_where("run = $1", {run}, connection_);
  if (found.empty()) not_found("result of run", run);
  return std::move(found.front());
}

std::vector<ModelResult> Transaction::results(Id scenario, const ListPart& part) {
  return results_where("scenario = $1 AND id > $2 ORDER BY id LIMIT $3",
                       {scenario, part.after, std::int64_t{part.n}}, connection_);
}

// Fields

void Transaction::know(const StoredFields& fields) {
  connection_.query("INSERT INTO fields VALUES ($1, $2, $3, $4) ON CONFLICT DO NOTHING",
                    {fields.digest, fields.bytes, fields.by, now_});
}

std::optional<StoredFields> Transaction::fields(const std::string& digest) {
  const auto row = connection_.query("SELECT digest, bytes, by, at FROM fields WHERE digest = $1", {digest});
  if (!row->next()) return std::nullopt;
  return StoredFields{
      .digest = row->text(0), .bytes = row->integer(1), .by = row->text(2), .at = row->real(3)};
}

// Quarantine

Quarantined Transaction::quarantine(Quarantined what) {
  const auto row = connection_.query(
      "INSERT INTO quarantine (kind, document, reason, by, at) VALUES ($1, $2, $3, $4, $5) RETURNING id",
      {what.kind, what.document, what.reason, what.by, now_});
  row->next();
  return quarantined(row->integer(0));
}

Quarantined Transaction::quarantined(Id id) {
  const auto row =
      connection_.query("SELECT id, kind, document, reason, by, at FROM quarantine WHERE id = $1", {id});
  if (!row->next()) not_found("quarantined record", id);
  return quarantined_in(*row);
}

std::vector<Quarantined> Transaction::quarantine_list(const ListPart& part) {
  return list_of(connection_.query("SELECT id, kind, document, reason, by, at FROM quarantine WHERE id > $1 "
                                   "ORDER BY id LIMIT $2",
                                   {part.after, std::int64_t{part.n}}),
                 quarantined_in);
}

std::map<std::string, std::int64_t> Transaction::counts() {
  std::map<std::string, std::int64_t> counts;
  for (const char* table : {"scenarios", "results", "fields", "quarantine"}) {
    const auto row = connection_.query("SELECT count(*) FROM " + std::string(table), {});
    if (row->next()) counts[table] = row->integer(0);
  }
  for (const auto& entry : run_states.entries) counts["runs_" + std::string(entry.name)] = 0;
  const auto rows = connection_.query("SELECT state, count(*) FROM runs GROUP BY state", {});
  while (rows->next()) counts["runs_" + rows->text(0)] = rows->integer(1);
  return counts;
}

}  // namespace elrom::repository
