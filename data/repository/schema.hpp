#pragma once
// The tables, in steps: each version of the schema is one step above the one before, and an older database is
// brought up by the steps that it lacks. A step that was ever released is never changed.

#include <string>
#include <vector>

#include "database.hpp"

namespace elrom::repository {

enum class ColumnType { integer, real, text };
struct Column {
  std::string name;
  ColumnType type;
};
/// A table as all steps together have made it.
struct Table {
  std::string name;
  std::vector<Column> columns;
  [[nodiscard]] bool is_numbered() const { return columns.front().name == "id"; }
};
/// Those that hold what callers brought.
[[nodiscard]] const std::vector<Table>& tables();

/// Number of steps that this ELROM knows.
[[nodiscard]] int schema_steps();
/// Takes the steps that the database lacks, up to `last`, in one transaction.
void bring_up(Backend& backend, Connection& connection, int last = schema_steps());

}  // namespace elrom::repository
