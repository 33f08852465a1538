#pragma once
// What the readers of case files (CSV, JSON, TOML) share: named values with units on their way into a schema.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"

namespace elrom::field::detail {

/// SI unit and display unit of an input declared as "name [symbol]". @throws InputError (unknown unit)
[[nodiscard]] InputInfo input_info(std::string_view name, std::string_view symbol, const std::string& where);
/// @throws InputError when `symbol` is unknown or of another dimension than the input
[[nodiscard]] double to_si(double value, std::string_view symbol, const InputInfo& input,
                           const std::string& where);
/// A column for people: without a heading, or called comment, note or remark (also in the plural).
[[nodiscard]] bool is_comment_column(std::string_view heading);
/// Headings "name [unit]" of the inputs matched to a schema.
struct Columns {
  std::vector<std::size_t> position;  ///< place among the headings of every input, (n_inputs)
  std::vector<std::string> symbol;    ///< unit as written, or the display unit where none is, (n_inputs)
};
/// @throws InputError for an unknown or repeated input, missing ones (all of them named), a unit of another
/// dimension
[[nodiscard]] Columns match_columns(const std::vector<std::string>& headings, const InputSchema& schema,
                                    const std::string& where);
/// Fraction of full load from a value as written. @throws InputError unless it is one
[[nodiscard]] double checked_load(double value, std::string_view symbol, const std::string& where);
/// Names become file names, so they hold no path and no control characters. @throws InputError
void check_case_name(const std::string& name, const std::string& where);
/// @throws InputError for the first name that appears twice
void check_unique_names(const std::vector<CaseInputs>& cases, const std::string& where);

/// Readers of one format each.
[[nodiscard]] std::vector<CaseInputs> read_cases_csv(const std::filesystem::path& path,
                                                     const InputSchema& schema);
[[nodiscard]] std::vector<CaseInputs> read_cases_json(const std::filesystem::path& path,
                                                      const InputSchema& schema);
[[nodiscard]] std::vector<CaseInputs> read_cases_toml(const std::filesystem::path& path,
                                                      const InputSchema& schema);

}  // namespace elrom::field::detail
