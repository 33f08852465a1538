#pragma once
// What the C interfaces share: no exception leaves them; each becomes a status and a line of text kept for
// the calling thread. Every library has its own line.

#include <exception>
#include <string>

#include "elrom/base/error.hpp"

namespace elrom::base {

/// Why the last call of this thread failed.
inline thread_local std::string c_last_error;

inline int c_failed(ExitStatus status, const char* message) noexcept {
  try {
    c_last_error = message;
  } catch (...) {
    c_last_error.clear();
  }
  return static_cast<int>(status);
}

/// @return 0, or the status of what `work` threw
template <class Work>
int c_guarded(const Work& work) noexcept {
  try {
    work();
    return 0;
  } catch (const Error& error) {
    return c_failed(error.status(), error.what());
  } catch (const std::exception& error) {
    return c_failed(ExitStatus::internal, error.what());
  } catch (...) {
    return c_failed(ExitStatus::internal, "unknown failure");
  }
}

/// @throws UsageError for a pointer that is not given
inline void c_need(bool given, const char* what) {
  if (!given) throw UsageError(std::string("null pointer: ") + what);
}

}  // namespace elrom::base
