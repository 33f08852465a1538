#pragma once
// The command line of elrom-predict.

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elrom/field/planes.hpp"
#include "elrom/fields/formats.hpp"
#include "elrom/fields/onto_options.hpp"
#include "elrom/model/cells.hpp"

namespace elrom::fields {

struct Arguments {
  std::filesystem::path bundle;
  std::filesystem::path cases;             ///< empty: one case from `settings` alone; "-": standard input
  std::vector<std::string> case_patterns;  ///< empty: all cases of the table
  std::vector<std::string> settings;       ///< "name=value [unit]"
  std::string name;                        ///< of the case that settings make; empty: made of them
  std::vector<std::string> sweeps;         ///< "name=start:stop:step [unit]"
  bool grid = false;                       ///< every combination of the sweeps, not one at a time
  std::string output = ".";                ///< folder, or "-" for standard output
  std::vector<Format> formats;             ///< at least one
  std::filesystem::path summary;           ///< table with a line a case; empty: none
  std::filesystem::path page;              ///< curves over what is swept; empty: none
  std::vector<std::string> fields;
  field::Planes planes;
  std::optional<model::Box> region;
  OntoOptions onto;
  bool best_build_only = false;
  std::optional<double> level;  ///< of the prediction intervals
  bool profile = false;
  bool strict = false;
  bool audit = false;     ///< physics audit of every case, in the terminal and the file
  bool conserve = false;  ///< smallest change to the input inventory and the inlets' gas flow
  bool timing = false;
  bool verbose = false;  ///< a line for every case, however many
  bool verify = true;
  bool sync = true;   ///< wait until a file is on the disk before it gets its name
  int n_threads = 0;  ///< 0: all

  [[nodiscard]] bool to_standard_output() const { return output == "-"; }
  [[nodiscard]] bool writes_text() const {
    return std::ranges::any_of(formats, [](Format format) { return info_of(format).write != nullptr; });
  }
  [[nodiscard]] bool writes(Format format) const {
    return std::find(formats.begin(), formats.end(), format) != formats.end();
  }
};

struct ParsedArguments {
  Arguments arguments;
  std::optional<int> exit_status;  ///< set when there is nothing left to do (--help, --version)
};

/// @throws UsageError for whatever the command line does not allow
[[nodiscard]] ParsedArguments parse_arguments(int argc, const char* const* argv);

}  // namespace elrom::fields
