#pragma once
// What is wrong with a command line before its values are looked at.

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace elrom::cli {

/// "elrom-data import"
[[nodiscard]] std::string full_name(const ::CLI::App& app);

/// @param words the command line without the program's name
/// @throws UsageError for an unknown command or option, with the nearest, for an option without its value,
/// and for one that is given twice and takes one value. Nothing is said where the user asks for help
void look_for_slips(const ::CLI::App& program, const std::vector<std::string>& words);

/// The same of what CLI11 found: what is missing, what is too much. @throws UsageError always
[[noreturn]] void refuse(const ::CLI::App& program, const ::CLI::ParseError& error);

}  // namespace elrom::cli
