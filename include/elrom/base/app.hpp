#pragma once
// The frame of every program: errors become one line on standard error and the exit status of error.hpp.

#include <functional>
#include <stop_token>
#include <string_view>

namespace elrom::base {

/// Runs `body`; catches everything. Prints "<program>: error: <message>". @return exit status
int run_app(std::string_view program, const std::function<int()>& body) noexcept;

/// From now on memory that is freed stays with the process: for programs that make large matrices over and
/// over, for which the system would clear every page again. Does nothing where the C library is not glibc.
void keep_freed_memory() noexcept;

/// Requested at the first SIGINT or SIGTERM (a second one ends the process at once). Installs the handlers on
/// first call.
[[nodiscard]] std::stop_token interrupt_token();

}  // namespace elrom::base
