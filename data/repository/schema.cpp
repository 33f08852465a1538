#include "schema.hpp"

#include <array>

#include "elrom/base/text.hpp"
#include "transact.hpp"

namespace elrom::repository {
namespace {

// {numbering}: a column that numbers its rows, in the database's own words.
constexpr std::array steps{
    R"(
CREATE TABLE inputs (digest TEXT PRIMARY KEY, document TEXT NOT NULL);
CREATE TABLE scenarios (id {numbering}, revision BIGINT NOT NULL, name TEXT NOT NULL UNIQUE, boiler TEXT NOT NULL,
  note TEXT NOT NULL, load DOUBLE PRECISION NOT NULL, inputs TEXT NOT NULL, verdict TEXT NOT NULL, reason TEXT NOT NULL,
  by TEXT NOT NULL, at DOUBLE PRECISION NOT NULL);
CREATE TABLE runs (id {numbering}, revision BIGINT NOT NULL, scenario BIGINT NOT NULL, inputs TEXT NOT NULL,
  model TEXT NOT NULL, state TEXT NOT NULL, worker TEXT NOT NULL, lease TEXT NOT NULL, lease_until DOUBLE PRECISION NOT NULL,
  not_before DOUBLE PRECISION NOT NULL, attempts BIGINT NOT NULL, reason TEXT NOT NULL, by TEXT NOT NULL,
  at DOUBLE PRECISION NOT NULL);
CREATE INDEX runs_to_do ON runs (model, state, id);
CREATE INDEX runs_of_scenario ON runs (scenario, id);
CREATE TABLE results (id {numbering}, run BIGINT NOT NULL UNIQUE, scenario BIGINT NOT NULL, inputs TEXT NOT NULL,
  model TEXT NOT NULL, version TEXT NOT NULL, verdict TEXT NOT NULL, reason TEXT NOT NULL, document TEXT NOT NULL,
  fields TEXT NOT NULL, at DOUBLE PRECISION NOT NULL);
CREATE INDEX results_of_scenario ON results (scenario, id);
CREATE TABLE lineage (run BIGINT NOT NULL, source BIGINT NOT NULL, PRIMARY KEY (run, source));
CREATE TABLE fields (digest TEXT PRIMARY KEY, bytes BIGINT NOT NULL, by TEXT NOT NULL, at DOUBLE PRECISION NOT NULL);
CREATE TABLE quarantine (id {numbering}, kind TEXT NOT NULL, document TEXT NOT NULL, reason TEXT NOT NULL,
  by TEXT NOT NULL, at DOUBLE PRECISION NOT NULL);
CREATE TABLE tokens (name TEXT PRIMARY KEY, role TEXT NOT NULL, hash TEXT NOT NULL, at DOUBLE PRECISION NOT NULL);
CREATE TABLE calls (key TEXT PRIMARY KEY, digest TEXT NOT NULL, status BIGINT NOT NULL, body TEXT NOT NULL,
  tag TEXT NOT NULL, place TEXT NOT NULL, at DOUBLE PRECISION NOT NULL);
CREATE INDEX calls_by_age ON calls (at))",
    // 1.1: what builds on a result is asked for with every result
    "CREATE INDEX lineage_by_source ON lineage (source)"};

int steps_taken(Connection& connection) {
  connection.query("CREATE TABLE IF NOT EXISTS schema_steps (number BIGINT PRIMARY KEY)", {});
  const auto row = connection.query("SELECT coalesce(max(number), 0) FROM schema_steps", {});
  return row->next() ? static_cast<int>(row->integer(0)) : 0;
}

void take_step(const std::string& step, const std::string& numbering, Connection& connection) {
  const std::string mark = "{numbering}";
  for (auto statement : base::split(step, ';')) {
    for (auto at = statement.find(mark); at != std::string::npos; at = statement.find(mark))
      statement.replace(at, mark.size(), numbering);
    connection.query(statement, {});
  }
}

/// "id:i name:t load:r" without its table.
Table table_of(const std::string& name, const std::string& columns) {
  Table table{.name = name, .columns = {}};
  for (const auto& column : base::split(columns, ' ')) {
    const auto type = column.back() == 'i'   ? ColumnType::integer
                      : column.back() == 'r' ? ColumnType::real
                                             : ColumnType::text;
    table.columns.push_back({column.substr(0, column.size() - 2), type});
  }
  return table;
}

}  // namespace

const std::vector<Table>& tables() {
  static const std::vector<Table> all{
      table_of("inputs", "digest:t document:t"),
      table_of("scenarios",
               "id:i revision:i name:t boiler:t note:t load:r inputs:t verdict:t reason:t by:t at:r"),
      table_of(
          "runs",
          "id:i revision:i scenario:i inputs:t model:t state:t worker:t lease:t lease_until:r not_before:r "
          "attempts:i reason:t by:t at:r"),
      table_of(
          "results",
          "id:i run:i scenario:i inputs:t model:t version:t verdict:t reason:t document:t fields:t at:r"),
      table_of("lineage", "run:i source:i"),
      table_of("fields", "digest:t bytes:i by:t at:r"),
      table_of("quarantine", "id:i kind:t document:t reason:t by:t at:r"),
      table_of("tokens", "name:t role:t hash:t at:r"),
      table_of("calls", "key:t digest:t status:i body:t tag:t place:t at:r")};
  return all;
}

int schema_steps() { return static_cast<int>(steps.size()); }

void bring_up(Backend& backend, Connection& connection, int last) {
  transact(connection, true, [&] {
    backend.lock_schema(connection);
    for (int number = steps_taken(connection) + 1; number <= last; ++number) {
      take_step(steps[static_cast<std::size_t>(number - 1)], backend.numbering(), connection);
      connection.query("INSERT INTO schema_steps VALUES ($1)", {std::int64_t{number}});
    }
    connection.query("UPDATE about SET value = $1 WHERE key = 'format_minor' AND CAST(value AS INTEGER) < $2",
                     {std::to_string(last - 1), std::int64_t{last - 1}});
  });
}

}  // namespace elrom::repository
