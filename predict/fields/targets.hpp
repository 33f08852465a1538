#pragma once
// The files that a run writes: one a case and format, each whole or not at all.

#include <filesystem>
#include <memory>
#include <string>

#include "elrom/base/atomic_file.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/fields/arguments.hpp"

namespace elrom::fields {

/// Thread rule: any thread.
class Targets {
 public:
  explicit Targets(const Arguments& arguments) : folder_(arguments.output), sync_(arguments.sync) {}
  [[nodiscard]] std::filesystem::path path(Format format, const field::CaseInputs& inputs) const;
  [[nodiscard]] std::unique_ptr<base::AtomicFile> begin(Format format, const field::CaseInputs& inputs) const;
  /// A whole file at once. @throws SystemError
  void write(Format format, const field::CaseInputs& inputs, const std::string& text) const;

 private:
  std::filesystem::path folder_;
  bool sync_;
};

/// @throws SystemError
void write_to_standard_output(const std::string& text);

}  // namespace elrom::fields
