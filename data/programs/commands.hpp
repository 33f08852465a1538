#pragma once
// The subcommands of elrom-data, one file each (command_<name>.cpp); elrom_data.cpp puts them together.

#include <functional>

#include "elrom/cli/cli.hpp"

namespace elrom::programs {

/// What the chosen subcommand does once the command line is read; the result is the exit status.
using Work = std::function<int()>;

// Each adds its subcommand to the program; `chosen` is set to its work when the user calls it.
void add_import(cli::App& program, Work& chosen);
void add_mesh(cli::App& program, Work& chosen);
void add_inspect(cli::App& program, Work& chosen);
void add_check(cli::App& program, Work& chosen);
void add_remove(cli::App& program, Work& chosen);
void add_watch(cli::App& program, Work& chosen);
void add_generate(cli::App& program, Work& chosen);
void add_collisions(cli::App& program, Work& chosen);

}  // namespace elrom::programs
