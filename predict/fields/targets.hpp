#pragma once
// The files that a run writes: one a case and format (openfoam: a folder), each whole or not at all.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "elrom/base/atomic_file.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/fields/arguments.hpp"

namespace elrom::fields {

/// Thread rule: any thread.
class Targets {
 public:
  explicit Targets(const Arguments& arguments);
  /// Makes the folders, clears away what killed runs left half-written of these cases, and sees that summary
  /// and page can be written at the end. @throws SystemError
  void prepare(const Arguments& arguments, const std::vector<field::CaseInputs>& cases) const;
  /// Whether the output folder is the OpenFOAM case that is to be started.
  [[nodiscard]] bool in_case() const { return in_case_; }
  [[nodiscard]] std::filesystem::path path(Format format, const field::CaseInputs& inputs) const;
  [[nodiscard]] std::unique_ptr<base::AtomicFile> begin(Format format, const field::CaseInputs& inputs) const;
  /// A whole file at once. @throws SystemError
  void write(Format format, const field::CaseInputs& inputs, const std::string& text) const;

 private:
  std::filesystem::path folder_;
  std::string time_;  //!< of time folders
  bool sync_, in_case_;
};

/// @throws SystemError
void write_to_standard_output(const std::string& text);

}  // namespace elrom::fields
