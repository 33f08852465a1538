#include <gmock/gmock.h>

#include <cstdint>
#include <numeric>

#include "elrom/model/field_model.hpp"

namespace elrom::model {
namespace {

TEST(Workspace, SpansAreAlignedAndDoNotOverlap) {
  Workspace workspace;

  const auto a = workspace.floats(5), b = workspace.floats(100'000), c = workspace.floats(3);
  std::iota(a.begin(), a.end(), 0.0F);
  std::fill(b.begin(), b.end(), 7.0F);
  std::fill(c.begin(), c.end(), 9.0F);

  for (const auto span : {a, b, c}) EXPECT_EQ(reinterpret_cast<std::uintptr_t>(span.data()) % 64, 0U);
  EXPECT_THAT(a, ::testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(b, ::testing::Each(7.0F));
}

TEST(Workspace, AFrameGivesItsMemoryBackForReuse) {
  Workspace workspace;
  const auto outer = workspace.floats(10);
  const float *first = nullptr, *second = nullptr;

  {
    const Workspace::Frame frame(workspace);
    first = workspace.floats(300'000).data();
  }
  {
    const Workspace::Frame frame(workspace);
    second = workspace.floats(300'000).data();
  }

  EXPECT_EQ(first, second);
  EXPECT_NE(first, outer.data());
}

}  // namespace
}  // namespace elrom::model
