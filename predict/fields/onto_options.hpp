#pragma once
// The options of predictions on another mesh.

#include <string>
#include <vector>

#include "elrom/fields/arguments.hpp"

namespace elrom::cli {
class App;
}

namespace elrom::fields {

/// What is read as text, and understood when all of the command line is there.
struct OntoTexts {
  std::string interpolation = "conservative";
  std::vector<std::string> names;
};

void add_onto_options(cli::App& app, OntoOptions& options, OntoTexts& texts);
/// @param arguments with its formats. @throws UsageError for texts that cannot be understood, and for options
/// that do not go together
void finish_onto_options(Arguments& arguments, const OntoTexts& texts);

}  // namespace elrom::fields
