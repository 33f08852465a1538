#include "elrom/io/stage_cache.hpp"

#include <gtest/gtest.h>

#include "support/changed_members.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::io {
namespace {

struct Context {
  int n_threads = 1;
  int* computed;
};

template <int code>
struct Doubling {
  static constexpr const char* stage = "doubling";
  static constexpr int version = code;
  double value = 1;
  std::string unit = "m";
  std::vector<double> more = {};
  [[nodiscard]] TensorFile compute(const Context& context) const {
    ++*context.computed;
    TensorFile file;
    file.set_text("twice", std::to_string(2 * value) + unit);
    return file;
  }
};
using Stage = Doubling<1>;

class Stages : public ::testing::Test {
 protected:
  template <class Any>
  std::string twice(const Any& stage, int n_threads = 1) {
    return cache.get("name", stage, Context{n_threads, &computed}).text("twice");
  }
  test::TemporaryFolder folder;
  StageCache cache{folder.path()};
  int computed = 0;
};

TEST_F(Stages, AreComputedOnceWhateverTheContext) {
  EXPECT_EQ(twice(Stage{}), twice(Stage{}, 8));
  EXPECT_EQ(computed, 1);
  EXPECT_EQ(StageCache(folder.path()).get("name", Stage{}, Context{1, &computed}).text("stage"), "doubling");
  EXPECT_EQ(computed, 1);
}

TEST_F(Stages, AreComputedAnewForEveryMember) {
  (void)twice(Stage{});
  for (const auto& changed : test::each_member_changed(Stage{})) {
    computed = 0;
    (void)twice(changed);
    EXPECT_EQ(computed, 1);
  }
  computed = 0;
  (void)twice(Stage{});
  EXPECT_EQ(computed, 0) << "earlier inputs cost nothing";
}

TEST_F(Stages, AreComputedAnewForOtherCode) {
  (void)twice(Doubling<1>{});
  (void)twice(Doubling<2>{});
  EXPECT_EQ(computed, 2);
}

TEST_F(Stages, AreComputedAnewFromADamagedFile) {
  const auto expected = twice(Stage{});
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) - 1);
  EXPECT_EQ(twice(Stage{}), expected);
  EXPECT_EQ(computed, 2);
}

TEST_F(Stages, WithoutAFolderNothingIsKept) {
  const StageCache none;
  (void)none.get("name", Stage{}, Context{1, &computed});
  (void)none.get("name", Stage{}, Context{1, &computed});
  EXPECT_EQ(computed, 2);
  EXPECT_TRUE(none.path("checkpoint", "name", Stage{}, ".part").empty());
}

}  // namespace
}  // namespace elrom::io
