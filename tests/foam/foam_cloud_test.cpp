#include "elrom/foam/foam_cloud.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "elrom/base/error.hpp"
#include "foam_box.hpp"
#include "support/throws.hpp"

namespace elrom::foam {
namespace {

class FoamCloudTest : public ::testing::Test {
 protected:
  FoamCloudTest() {
    write_two_cells(folder_);
    mesh_ = read_poly_mesh(folder_.path());
  }
  [[nodiscard]] std::vector<Parcel> draw(std::size_t n, double spread = 0, std::uint64_t seed = 1) const {
    return draw_cloud(mesh_, {fraction_, diameter_, x_, y_, z_}, {.n_parcels = n, .spread = spread},
                      base::Seed(seed));
  }
  static double volume_of(const Parcel& parcel) {
    return parcel.count * std::numbers::pi / 6 * std::pow(parcel.diameter, 3);
  }

  const test::TemporaryFolder folder_;
  FoamMesh mesh_;
  // Volumes are 3 and 4 m3: 0.3 and 0.1 m3 of solids.
  std::vector<float> fraction_{0.1F, 0.025F}, diameter_{2e-4F, 4e-4F}, x_{1, 2}, y_{3, 4}, z_{5, 6};
};

TEST_F(FoamCloudTest, HoldsTheSolidsOfTheFieldExactly) {
  for (const std::size_t n : {1, 7, 4000}) {
    const auto parcels = draw(n);
    double sum = 0;
    for (const auto& parcel : parcels) sum += volume_of(parcel);
    EXPECT_EQ(parcels.size(), n);
    EXPECT_NEAR(sum, 0.4, 1e-8);
  }
}

TEST_F(FoamCloudTest, EveryCellGetsItsShareOfParcelsToOne) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const auto parcels = draw(10, 0, seed);
    const auto below =
        std::count_if(parcels.begin(), parcels.end(), [](const auto& p) { return p.cell == 0; });
    EXPECT_TRUE(below == 7 || below == 8) << below;  // 7.5 is its share
  }
}

TEST_F(FoamCloudTest, ParcelsLieInTheirTetrahedronWithTheirCellsValues) {
  const FoamCells cells(mesh_);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto parcels = draw(4000);
  for (const auto& parcel : parcels) {
    EXPECT_TRUE(cells.contains(parcel.cell, parcel.position));
    EXPECT_NEAR(parcel.weights.sum(), 1, 1e-12);
    EXPECT_EQ(parcel.diameter, static_cast<double>(diameter_[parcel.cell]));
    EXPECT_EQ(parcel.velocity, Eigen::Vector3d(x_[parcel.cell], y_[parcel.cell], z_[parcel.cell]));
    bool found = false;
    for (const auto& tet : cells.tetrahedra(parcel.cell))
      found = found || (tet.face == parcel.face && tet.point == parcel.point &&
                        (tet.corners * parcel.weights - parcel.position).norm() < 1e-12);
    EXPECT_TRUE(found);
    if (parcel.cell == 1) sum += parcel.position;
  }
  // Uniform in the upper box, 4 x 1 x 1 m: within 4 standard errors of its middle.
  const Eigen::Vector3d mean = sum / 1000;
  EXPECT_NEAR(mean[0], 2, 4 * 4 / std::sqrt(12.0 * 1000));
  EXPECT_NEAR(mean[1], 0.5, 4 / std::sqrt(12.0 * 1000));
  EXPECT_NEAR(mean[2], 1.5, 4 / std::sqrt(12.0 * 1000));
}

TEST_F(FoamCloudTest, ASpreadIsThatOfAllParcelsAndKeepsMassAndMeanDiameter) {
  for (const double wanted : {0.4, 0.6, 0.1}) {
    const auto parcels = draw(4000, wanted);
    double diameter = 0, logarithm = 0, square = 0, volume = 0;
    for (const auto& parcel : parcels) {
      volume += volume_of(parcel);
      diameter += parcel.diameter / 4000;
      logarithm += std::log(parcel.diameter) / 4000;
      square += std::pow(std::log(parcel.diameter), 2) / 4000;
    }
    const double between = std::log(2) * std::sqrt(0.75 * 0.25);  // 3 in 4 parcels have half the diameter
    EXPECT_NEAR(volume, 0.4, 1e-8);
    EXPECT_NEAR(diameter, 2.5e-4, 2.5e-4 * 4 * wanted / std::sqrt(4000));
    EXPECT_NEAR(std::sqrt(square - logarithm * logarithm), std::max(wanted, between), 0.02);
  }
}

TEST_F(FoamCloudTest, WithoutSolidsThereAreNoParcels) {
  fraction_ = {0, 0};
  EXPECT_TRUE(draw(100).empty());
}

TEST_F(FoamCloudTest, SolidsWithoutADiameterAreRefused) {
  diameter_ = {2e-4F, 0};
  EXPECT_ERROR(InputError, "solids without a diameter in cell 1", draw(100));
}

}  // namespace
}  // namespace elrom::foam
