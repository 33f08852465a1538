#pragma once
// What is kept out: boundary conditions that no furnace can have, and files of fields that no CFD or model
// can have made. What is wrong is an InputError, whose words are the reason that goes with it into
// quarantine; what lies outside the trained range goes on, marked with the guard's verdict.
//
// Thread rule: pure functions; HDF5 files by one thread at a time.

#include <filesystem>
#include <optional>
#include <string>

#include "elrom/model/guard.hpp"

namespace elrom::repository {

/// Boundary conditions that passed.
struct JudgedInputs {
  field::CaseInputs inputs;                     ///< SI, in the schema's order
  std::string document;                         ///< {"primary_air [kg/s]": 161.1, ...}: SI, sorted by name
  std::optional<model::Assessment> assessment;  ///< nothing without a guard
};

/// @param one {"case": ..., "load": ..., "inputs": {"primary_air [kg/s]": 161.1, ...}}
/// @param where for messages
/// @param schema that the inputs must fill; nullptr: any names, each with a known unit
/// @param guard of the same schema; nullptr: nobody says what is usual
/// @throws InputError for an unknown, missing or repeated name, a unit of another dimension, a value that is
/// no
///         finite number or that no furnace can have
[[nodiscard]] JudgedInputs judge_inputs(const std::string& one, const std::string& where,
                                        const field::InputSchema* schema, const model::Guard* guard);

/// @param file a prediction (data/FORMATS.md, kind "elrom-prediction")
/// @param mesh_digest of the mesh that it must be on; empty: any
/// @throws InputError for another kind of file, one that is broken, of another mesh, or whose values are not
/// finite
///         or beyond what a field can have
void judge_fields(const std::filesystem::path& file, const std::string& mesh_digest);

}  // namespace elrom::repository
