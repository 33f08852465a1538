#include <gmock/gmock.h>

#include <csignal>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::io {
namespace {

void nothing() {}

TEST(Survive, ACrashWhileReadingIsAnErrorThatNamesTheFile) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.h5", "bytes that kill a library");
  const auto crash = [&] {
    survive(path, "store", [] { std::raise(SIGSEGV); });
    return 0;
  };

  EXPECT_ERROR(InputError, "the HDF5 library crashed on this file in " + path.string(), crash());
}

TEST(Survive, AFileIsTriedOnceForEachWorkUntilItChanges) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.h5", "harmless");
  const auto crash = [] { std::raise(SIGSEGV); };

  survive(path, "store", nothing);

  EXPECT_NO_THROW(survive(path, "store", crash));
  EXPECT_THROW(survive(path, "mesh", crash), InputError);
  folder.write("a.h5", "of another size now");
  EXPECT_THROW(survive(path, "store", crash), InputError);
}

TEST(Survive, WhatFailedOnceIsTriedAgain) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("a.h5", "harmless");

  EXPECT_THROW(survive(path, "store", [] { throw InputError("no store"); }), InputError);
  EXPECT_NO_THROW(survive(path, "store", nothing));
}

}  // namespace
}  // namespace elrom::io
