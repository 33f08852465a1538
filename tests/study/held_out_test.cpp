#include "elrom/study/held_out.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "elrom/base/error.hpp"

namespace elrom::study {
namespace {

TEST(HeldOut, HeldOutCasesAreFoundByPattern) {
  const auto split = hold_out({"train_000", "load_064", "rep1_064", "train_001"}, {"load_*", "rep*"});

  EXPECT_THAT(split.building, ::testing::ElementsAre(0, 3));
  EXPECT_THAT(split.held_out, ::testing::ElementsAre(1, 2));
}

TEST(HeldOut, AnExcludedCaseIsNotHeldOutEither) {
  const auto split = hold_out({"a1", "b1", "a2", "b2", "b3"}, {"a*"}, {"*2"});

  EXPECT_THAT(split.excluded, ::testing::ElementsAre(2, 3));
  EXPECT_THAT(split.held_out, ::testing::ElementsAre(0));
  EXPECT_THAT(split.building, ::testing::ElementsAre(1, 4));
}

TEST(HeldOut, HoldingOutAlmostEverythingIsRefused) {
  EXPECT_THROW((void)hold_out({"a", "b"}, {"*"}), UsageError);
}

TEST(HeldOut, FileReadsBack) {
  const auto path =
      std::filesystem::temp_directory_path() / ("split_" + std::to_string(::getpid()) + ".json");
  write_split(path, {"case", {"a"}, {"b"}, {"c", "d"}, {"e"}, {"f"}});

  const auto split = read_split(path);

  EXPECT_THAT(split.test, ::testing::ElementsAre("c", "d"));
  EXPECT_THAT(split.held_out, ::testing::ElementsAre("e"));
  EXPECT_THAT(split.excluded, ::testing::ElementsAre("f"));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace elrom::study
