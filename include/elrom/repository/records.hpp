#pragma once
// What the repository keeps: plain records. Times are seconds since 1970 (UTC); documents are JSON texts that
// the repository stores as they are.
//
// Thread rule: plain data.

#include <cstdint>
#include <string>
#include <vector>

#include "elrom/base/enum_names.hpp"

namespace elrom::repository {

using Id = std::int64_t;  ///< from 1

enum class Role { reader, model, admin };  ///< each may do what those before it may
inline constexpr base::EnumNames<Role, 3> roles{
    "role", {{Role::reader, "reader"}, {Role::model, "model"}, {Role::admin, "admin"}}};

enum class RunState { waiting, running, done, failed, quarantined };
inline constexpr base::EnumNames<RunState, 5> run_states{"state of a run",
                                                         {{RunState::waiting, "waiting"},
                                                          {RunState::running, "running"},
                                                          {RunState::done, "done"},
                                                          {RunState::failed, "failed"},
                                                          {RunState::quarantined, "quarantined"}}};

/// An operating point of a boiler. A change makes its next revision; runs name the inputs that they were made
/// for.
struct Scenario {
  Id id = 0;
  std::int64_t revision = 1;
  std::string name, boiler, note;
  double load = 0;              ///< fraction of full load; below 0: not told
  std::string inputs;           ///< document: {"primary_air [kg/s]": 161.1, ...}, SI
  std::string inputs_digest;    ///< SHA-256 of it
  std::string verdict, reason;  ///< the guard's; empty: no model judged it
  std::string by;               ///< the token that brought it
  double at = 0;
};

/// One model's work on one scenario's inputs.
struct Run {
  Id id = 0;
  std::int64_t revision = 1;
  Id scenario = 0;
  std::string inputs_digest, model;
  RunState state = RunState::waiting;
  std::string worker, lease;  ///< who works on it, and the secret that shows it; empty: nobody
  double lease_until = 0;
  double not_before = 0;    ///< a waiting run is not given out earlier
  int attempts = 0;         ///< times it was given out
  std::string reason;       ///< of failure, quarantine or another try
  std::vector<Id> sources;  ///< results that it builds on
  std::string by;
  double at = 0;
};

/// What a run came to.
struct ModelResult {
  Id id = 0, run = 0, scenario = 0;
  std::string inputs_digest, model;
  std::string version;          ///< of the model: a bundle's digest, a program's version
  std::string verdict, reason;  ///< the guard's, where the model has one
  std::string document;         ///< what the model says in numbers and words
  std::string fields;           ///< digest of its fields' file; empty: none
  std::vector<Id> followed_by;  ///< runs that build on it
  double at = 0;
};

struct StoredFields {
  std::string digest;  ///< SHA-256 of the file
  std::int64_t bytes = 0;
  std::string by;
  double at = 0;
};

/// What was sent and is wrong: kept with the reason, and given to no model.
struct Quarantined {
  Id id = 0;
  std::string kind;  ///< "scenario", "fields", "result"
  std::string document, reason, by;
  double at = 0;
};

struct Token {
  std::string name;
  Role role = Role::reader;
  double at = 0;
};

}  // namespace elrom::repository
