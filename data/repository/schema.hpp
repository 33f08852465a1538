#pragma once
// The tables, in steps: each version of the schema is one step above the one before, and an older database is
// brought up by the steps that it lacks. A step that was ever released is never changed.

#include "database.hpp"

namespace elrom::repository {

/// Number of steps that this ELROM knows.
[[nodiscard]] int schema_steps();
/// Takes the steps that the database lacks, up to `last`, in one transaction.
void bring_up(Backend& backend, Connection& connection, int last = schema_steps());

}  // namespace elrom::repository
