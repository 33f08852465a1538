#include "zones.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/toy_furnace.hpp"

namespace elrom::methods {
namespace {

FundamentalDomain domain_of(const field::CaseSet& cases) {
  return {cases, {}, symmetry_classes(cases.mirrors.size())};
}

/// 66 planes of 2 cells, as high as the furnace of design.
FundamentalDomain tall() { return domain_of({.mesh = field::make_furnace_mesh({}, 1, 2, 66)}); }

TEST(Zones, WeightsAddUpToOneOnEveryPlane) {
  const FundamentalDomain domain = tall();
  for (const std::size_t n : {2U, 3U, 5U}) {
    MatrixF sum = MatrixF::Zero(1, 132);
    for (const Zone& zone : zones_of(domain, n)) zone.add(sum, MatrixF::Ones(1, zone.weights.size()));
    EXPECT_TRUE(sum.isOnes(1e-6F)) << n << " zones";
  }
}

TEST(Zones, NeighboursFadeIntoEachOtherHalfwayBetweenTheirMiddles) {
  const auto zones = zones_of(tall(), 3);  // middles at planes 0, 32.5 and 65; fading over 8.125 planes

  ASSERT_EQ(zones.size(), 3U);
  EXPECT_EQ(zones[0].first_plane, 0U);
  EXPECT_EQ(zones[0].n_planes, 21U);  // 16.25 + 4.06 is the last height that counts
  EXPECT_EQ(zones[1].first_plane, 13U);
  EXPECT_EQ(zones[1].n_planes, 40U);
  EXPECT_EQ(zones[1].first_cell, 26);
  EXPECT_NEAR(zones[0].weights[32], 0.5 + 0.25 / 8.125, 1e-6);  // plane 16
  EXPECT_EQ(zones[1].weights[40], 1);                           // plane 33
}

TEST(Zones, FewPlanesAreOneZone) {
  const auto zones = zones_of(domain_of({.mesh = field::make_furnace_mesh({}, 4, 6, 5)}), 3);

  ASSERT_EQ(zones.size(), 1U);
  EXPECT_EQ(zones[0].n_planes, 5U);
  EXPECT_TRUE(zones[0].weights.isOnes(0));
}

TEST(Zones, AMirrorThatExchangesPlanesLeavesOneZone) {
  field::CaseSet cases = test::toy_cases(2);
  ASSERT_EQ(zones_of(domain_of(cases), 3).size(), 3U);
  cases.mirrors.push_back(cases.mirrors.front());
  std::ranges::reverse(cases.mirrors.back().cell_from);  // upside down

  EXPECT_EQ(zones_of(domain_of(cases), 3).size(), 1U);
}

TEST(Zones, ProductsAreWeightedByCell) {
  const FundamentalDomain domain = tall();
  const Zone zone = zones_of(domain, 3)[1];
  const MatrixF a = MatrixF::Random(3, 132), b = MatrixF::Random(2, 132);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 2);
  for (Eigen::Index c = 0; c < zone.weights.size(); ++c)
    expected +=
        double{zone.weights[c]} * a.col(26 + c).cast<double>() * b.col(26 + c).cast<double>().transpose();

  EXPECT_TRUE(zone.gram(a, b).isApprox(expected, 1e-9));
  const MatrixF copy = a;
  EXPECT_TRUE(zone.gram(a, a).isApprox(zone.gram(a, copy), 1e-9));
}

}  // namespace
}  // namespace elrom::methods
