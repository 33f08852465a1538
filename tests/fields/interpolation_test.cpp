#include "interpolation.hpp"

#include <gmock/gmock.h>

#include <numeric>

namespace elrom::fields {
namespace {

Places places_of(const field::Mesh& mesh) { return {mesh.centre, mesh.volume, {}}; }

template <class Function>
std::vector<float> values_of(const MatrixD& centre, Function function) {
  std::vector<float> values;
  for (Eigen::Index i = 0; i < centre.rows(); ++i)
    values.push_back(static_cast<float>(function(centre(i, 0), centre(i, 1), centre(i, 2))));
  return values;
}

double wavy(double x, double y, double z) { return 2 + std::sin(x) + std::cos(y / 3) * z / 47; }

double integral_of(const std::vector<float>& values, const std::vector<double>& volume) {
  return std::inner_product(values.begin(), values.end(), volume.begin(), 0.0);
}

// Without a taper the nearest centre is always that of the cell around a point.
const field::TaperedFurnace furnace{.bottom_width_m = 10.6};
const field::Mesh fine = field::make_furnace_mesh(furnace, 8, 6, 12);
const field::Mesh coarse = field::make_furnace_mesh(furnace, 4, 3, 6);

TEST(Interpolation, ACellOfACoarserMeshTakesTheMeanOfItsChildren) {
  const Interpolator interpolator(fine, places_of(coarse), Interpolation::conservative, 1);
  const auto values = values_of(fine.centre, wavy);
  std::vector<float> result(coarse.n_cells());

  interpolator.apply(values, {}, result);

  EXPECT_EQ(interpolator.n_outside(), 0u);
  double sum = 0, volume = 0;  // of the eight children of the first cell
  for (const std::size_t child : {0, 1, 8, 9, 48, 49, 56, 57}) {
    sum += fine.volume[child] * values[child];
    volume += fine.volume[child];
  }
  EXPECT_NEAR(result[0], sum / volume, 1e-5);
  EXPECT_NEAR(integral_of(result, coarse.volume), integral_of(values, fine.volume),
              1e-6 * integral_of(values, fine.volume));
  EXPECT_NEAR(interpolator.integral(values), integral_of(values, fine.volume), 1e-2);
}

TEST(Interpolation, AFinerMeshHasNoHolesAndKeepsTheIntegral) {
  const Interpolator interpolator(coarse, places_of(fine), Interpolation::conservative, 2);
  const auto values = values_of(coarse.centre, wavy);
  std::vector<float> result(fine.n_cells());

  interpolator.apply(values, {}, result);

  EXPECT_EQ(interpolator.n_outside(), 0u);
  EXPECT_NEAR(integral_of(result, fine.volume), integral_of(values, coarse.volume),
              1e-3 * integral_of(values, coarse.volume));
}

TEST(Interpolation, VelocitiesAreWeighedByTheirPhaseSoThatMomentumIsKept) {
  const Interpolator interpolator(fine, places_of(coarse), Interpolation::conservative, 1);
  const auto velocity = values_of(fine.centre, wavy);
  const auto share =
      values_of(fine.centre, [](double x, double, double z) { return 0.01 * x + 0.3 / (1 + z); });
  std::vector<float> velocity_there(coarse.n_cells()), share_there(coarse.n_cells());

  interpolator.apply(velocity, share, velocity_there);
  interpolator.apply(share, {}, share_there);

  double before = 0, after = 0;
  for (std::size_t i = 0; i < fine.n_cells(); ++i) before += fine.volume[i] * share[i] * velocity[i];
  for (std::size_t i = 0; i < coarse.n_cells(); ++i)
    after += coarse.volume[i] * share_there[i] * velocity_there[i];
  EXPECT_NEAR(after, before, 1e-5 * before);
}

TEST(Interpolation, WherePhaseIsAbsentThePlainMeanIsTaken) {
  const Interpolator interpolator(fine, places_of(coarse), Interpolation::conservative, 1);
  const std::vector<float> velocity(fine.n_cells(), 3), none(fine.n_cells(), 0);
  std::vector<float> result(coarse.n_cells());

  interpolator.apply(velocity, none, result);

  for (const float value : result) EXPECT_EQ(value, 3);
}

TEST(Interpolation, TrilinearIsExactForAPlaneAwayFromWalls) {
  const auto from = field::make_furnace_mesh(furnace, 6, 6, 6);
  const auto plane = [](double x, double y, double z) { return 1 + 0.5 * x - 0.2 * y + 0.1 * z; };
  Places places;
  places.centre.resize(2, 3);
  places.centre << 5.1, 12.3, 20.2, 4.4, 15.5, 27.7;
  const Interpolator interpolator(from, places, Interpolation::trilinear, 1);
  std::vector<float> result(2);

  interpolator.apply(values_of(from.centre, plane), {}, result);

  EXPECT_EQ(interpolator.n_outside(), 0u);
  EXPECT_NEAR(result[0], plane(5.1, 12.3, 20.2), 1e-5);
  EXPECT_NEAR(result[1], plane(4.4, 15.5, 27.7), 1e-5);
}

TEST(Interpolation, PlacesOutsideTakeTheNearestCellAndAreCounted) {
  Places places;
  places.centre.resize(2, 3);
  places.centre << 5, 13, 20, 5, 13, 1000;
  const auto values = values_of(coarse.centre, [](double, double, double z) { return z; });
  std::vector<float> result(2);

  const Interpolator interpolator(coarse, places, Interpolation::trilinear, 1);
  interpolator.apply(values, {}, result);

  EXPECT_EQ(interpolator.n_outside(), 1u);
  EXPECT_FLOAT_EQ(result[1], values.back());
}

TEST(Interpolation, PartsThatLieInNoCellAreLeftOut) {
  // A case of the lowest layer of cells alone: what is above must not count as in it.
  auto places = places_of(coarse);
  places.centre = places.centre.topRows(12).eval();
  places.volume.resize(12);
  places.contains = [](std::size_t, const Eigen::Vector3d& x) { return x[2] < 47.0 / 6; };
  const auto values = values_of(fine.centre, [](double, double, double z) { return z < 47.0 / 6 ? 1 : 100; });
  std::vector<float> result(12);

  const Interpolator interpolator(fine, places, Interpolation::conservative, 1);
  interpolator.apply(values, {}, result);

  for (const float value : result) EXPECT_EQ(value, 1);
}

}  // namespace
}  // namespace elrom::fields
