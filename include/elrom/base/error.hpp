#pragma once
// Errors of the whole library: one root type, one subtype for each way a user
// can be at fault or out of luck. Libraries throw these and never exit or
// print; only base/app.hpp turns them into one line and an exit status.

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace elrom {

/// Exit status of every program; scripts rely on these numbers.
enum class ExitStatus : int {
  ok = 0,
  internal = 1,      ///< a fault of ours, or of the machine
  usage = 2,         ///< wrong command line or setting
  input = 3,         ///< a file's shape, format, unit or content is wrong
  validity = 4,      ///< a case lies outside the validity domain (--strict)
  numerical = 5,     ///< arithmetic that cannot end in finite numbers
  not_built = 6,     ///< a component that this build left out
  refused = 7,       ///< a comparison says no: the new model is not promoted
  nothing_new = 8,   ///< nothing to do: no new cases
  interrupted = 130  ///< Ctrl-C; the work done so far is kept
};

/// Parts of a message to the user; empty parts are left out.
/// Reads "<what> in <where>: found <found>, expected <expected>; <advice>".
struct Problem {
  std::string what;
  std::string where = {};  ///< file:dataset, file:line, field ...
  std::string found = {};  ///< shown without control characters, and only its beginning when it is long
  std::string expected = {};
  std::string advice = {};

  [[nodiscard]] std::string message() const;
};

class Error : public std::runtime_error {
 public:
  Error(ExitStatus status, const Problem& problem)
      : std::runtime_error(problem.message()),
        status_(status),
        problem_(std::make_shared<const Problem>(problem)) {}
  [[nodiscard]] ExitStatus status() const noexcept { return status_; }
  /// The parts that what() says in one line, for answers that keep them apart.
  [[nodiscard]] const Problem& problem() const noexcept { return *problem_; }

 private:
  ExitStatus status_;
  std::shared_ptr<const Problem> problem_;  ///< shared: copying an exception must not throw
};

/// Every subtype is built from a Problem, or from one ready sentence.
#define ELROM_ERROR_TYPE(Name, status)                                            \
  class Name : public Error {                                                     \
   public:                                                                        \
    explicit Name(const Problem& problem) : Error(status, problem) {}             \
    explicit Name(std::string sentence) : Error(status, {std::move(sentence)}) {} \
  };
ELROM_ERROR_TYPE(UsageError, ExitStatus::usage)
ELROM_ERROR_TYPE(InputError, ExitStatus::input)
ELROM_ERROR_TYPE(ValidityError, ExitStatus::validity)
ELROM_ERROR_TYPE(NumericalError, ExitStatus::numerical)
ELROM_ERROR_TYPE(NotBuiltError, ExitStatus::not_built)
ELROM_ERROR_TYPE(Interrupted, ExitStatus::interrupted)
ELROM_ERROR_TYPE(SystemError, ExitStatus::internal)
#undef ELROM_ERROR_TYPE

/// Our own mistakes (a broken precondition between components): checked in every build, because a wrong field
/// is worse than a stopped program. Throws std::logic_error with the place.
void check(bool condition, std::string_view what, const char* file = __builtin_FILE(),
           int line = __builtin_LINE());

}  // namespace elrom
