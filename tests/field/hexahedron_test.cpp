#include "elrom/field/hexahedron.hpp"

#include <gtest/gtest.h>

namespace elrom::field {
namespace {

TEST(Hexahedron, VolumesOfShapesWhoseCornersCoincide) {
  const Corner a{0, 0, 0}, b{2, 0, 0}, c{2, 3, 0}, d{0, 3, 0}, e{0, 0, 4}, f{2, 0, 4}, g{2, 3, 4}, h{0, 3, 4};

  EXPECT_DOUBLE_EQ(hexahedron_volume({a, b, c, d, e, f, g, h}), 24);
  EXPECT_DOUBLE_EQ(hexahedron_volume({a, b, d, d, e, f, h, h}), 12);  // wedge
  EXPECT_DOUBLE_EQ(hexahedron_volume({a, b, c, d, e, e, e, e}), 8);   // pyramid
  EXPECT_DOUBLE_EQ(hexahedron_volume({a, b, d, d, e, e, e, e}), 4);   // tetrahedron
  EXPECT_DOUBLE_EQ(hexahedron_volume({e, f, g, h, a, b, c, d}), -24);
}

}  // namespace
}  // namespace elrom::field
