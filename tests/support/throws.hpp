#pragma once
// An error's type and a part of its message in one expectation.

#include <gmock/gmock.h>

#include <string>

/// EXPECT_ERROR(InputError, "did you mean 'load'", read_cases(...))
#define EXPECT_ERROR(Type, fragment, ...)                                     \
  do {                                                                        \
    try {                                                                     \
      (void)(__VA_ARGS__);                                                    \
      ADD_FAILURE() << "no error was thrown";                                 \
    } catch (const Type& error) {                                             \
      EXPECT_THAT(std::string(error.what()), ::testing::HasSubstr(fragment)); \
    }                                                                         \
  } while (false)
