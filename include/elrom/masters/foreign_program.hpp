#pragma once
// A program that is not ours, as a file describes it (data/FORMATS.md, "Foreign program"): a folder of
// templates that is copied and filled in for each run, a command, and what it leaves.
//
// Thread rule: plain values and pure functions.

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/serve/master.hpp"

namespace elrom::masters {

struct ForeignProgram {
  std::string name;                 ///< for people and results: "MPPICFoam, OpenFOAM v1912"
  std::filesystem::path templates;  ///< folder
  std::string command;              ///< for /bin/sh, in the filled folder
  std::vector<std::string> needs;   ///< programs that must be there
  std::string install;              ///< how they come there, for messages
  double time_limit_s = std::numeric_limits<double>::infinity();
  std::optional<std::string>
      cfd_case;  ///< what it leaves: a CFD case as import reads it, named {{case}}; "." is the folder
  std::optional<std::string> document;  ///< a JSON file of results
};

/// @throws UsageError for a key that there is not, or a value that cannot be, with file and line
[[nodiscard]] ForeignProgram read_foreign_program(const std::filesystem::path& file);

/// @throws SystemError naming what is missing, and how it is installed
void expect_installed(const ForeignProgram& program);

/// What stands in a template for its {{blanks}}.
struct TemplateValues {
  std::string case_name;
  std::optional<double> load;
  field::InputSchema schema;
  std::vector<double> inputs;  ///< SI, in the schema's order
  std::string document;        ///< {{inputs}}: the JSON document of the inputs
};

/// Copies `from` to `to`; a file x.in becomes x with its blanks filled in: {{case}}, {{load}}, {{inputs}},
/// {{primary_air [t/h]}}.
/// @throws InputError for a blank that is none of these, with the nearest, for a unit of another dimension,
///         and for the load of a scenario that does not tell it; SystemError
void fill_templates(const std::filesystem::path& from, const std::filesystem::path& to,
                    const TemplateValues& values);
/// The same of one text. @param where for messages
[[nodiscard]] std::string fill_blanks(const std::string& text, const TemplateValues& values,
                                      const std::string& where);

/// A CFD case's way into the repository.
struct CaseOptions {
  std::filesystem::path mesh;         ///< reduced mesh
  std::filesystem::path furnace;      ///< description; empty: the one beside the mesh
  std::vector<std::string> accepted;  ///< kinds of findings that are only told
};

struct ForeignOptions {
  ForeignProgram program;
  std::string model;             ///< whose runs these are: "el3d"
  CaseOptions door;              ///< for a program that leaves a CFD case
  std::filesystem::path folder;  ///< one folder a run is made in it; that of a run that failed stays
};

/// The work of a foreign program. Before: inputs that no furnace can have end the run. After: its exit
/// status (75: to be tried again), then what it left: a case goes through import's checks and is sent on
/// the reduced mesh.
[[nodiscard]] serve::Master::Work foreign_work(const ForeignOptions& options, Log& log);

}  // namespace elrom::masters
