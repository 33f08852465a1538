#pragma once
// What is other in one bundle than in an earlier one: training cases, settings, methods and errors by field.
//
// Thread rule: pure functions of files.

#include <filesystem>
#include <string>
#include <vector>

namespace elrom::study {

struct FieldDifference {
  std::string field;
  std::string method_a, method_b;   ///< kind of model; empty: the bundle lacks the field
  double nrmse_a = 0, nrmse_b = 0;  ///< cross-validated, each on its own cases; NaN: not known
};

struct BundleDifference {
  std::vector<std::string> added, removed;  ///< training cases of B alone, of A alone
  std::vector<std::string> changed;         ///< of both, with other inputs or fields
  bool knows_content = false;               ///< both tell digests of their cases (bundles from 1.2)
  bool knows_settings = false;              ///< both tell their settings (from 1.2)
  std::vector<std::string> settings;        ///< "[section] key = a -> b"
  std::vector<FieldDifference> fields;
};

/// @throws InputError for a file that is no bundle
[[nodiscard]] BundleDifference difference_of(const std::filesystem::path& a, const std::filesystem::path& b);
[[nodiscard]] std::string in_words(const BundleDifference& difference);

}  // namespace elrom::study
