#include "elrom/ingest/resample.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "point_hull.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

constexpr double exactness = 1e-5;  // of the field's range; float32 keeps 6e-8

MatrixD random_cloud(std::size_t n, std::uint64_t seed) {
  base::Random random{base::Seed(seed)};
  MatrixD points(static_cast<Eigen::Index>(n), 3);
  for (Eigen::Index i = 0; i < points.size(); ++i) points.data()[i] = random.uniform(-2, 3);
  return points;
}

MatrixF linear_field(const MatrixD& centre, const std::array<double, 3>& slope) {
  MatrixF values(1, centre.rows());
  for (Eigen::Index i = 0; i < centre.rows(); ++i) {
    values(0, i) =
        static_cast<float>(7 + slope[0] * centre(i, 0) + slope[1] * centre(i, 1) + slope[2] * centre(i, 2));
  }
  return values;
}

// Targets in the hull of the source's centres.
std::vector<Eigen::Index> targets_inside(const MatrixD& source, const MatrixD& target) {
  std::vector<Point> points;
  for (Eigen::Index i = 0; i < source.rows(); ++i)
    points.push_back({source(i, 0), source(i, 1), source(i, 2)});
  const PointHull hull(std::move(points));
  std::vector<Eigen::Index> inside;
  for (Eigen::Index i = 0; i < target.rows(); ++i) {
    if (hull.contains({target(i, 0), target(i, 1), target(i, 2)}, 1e-9)) inside.push_back(i);
  }
  return inside;
}

// Largest error among the targets `inside`, relative to the field's range.
double worst_error(const Resampler& resampler, const MatrixD& source, const MatrixD& target,
                   const std::vector<Eigen::Index>& inside, const std::array<double, 3>& slope) {
  const auto values = linear_field(source, slope), exact = linear_field(target, slope);
  const auto result = resampler.apply(values);
  float worst = 0;
  for (const auto i : inside) worst = std::max(worst, std::abs(result(0, i) - exact(0, i)));
  return static_cast<double>(worst / (values.maxCoeff() - values.minCoeff()));
}

TEST(Resampler, ReproducesLinearFieldsOnTheShippedMeshes) {
  const auto cfd = read_el3d(ELROM_SOURCE_DIR "/data/cases/load_064.h5");
  const auto mesh = field::read_mesh(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5");
  const Resampler resampler(cfd.centre, cfd.volume, mesh.centre, 2);
  const auto inside = targets_inside(cfd.centre, mesh.centre);

  EXPECT_EQ(inside.size(), 18U * 40U * 64U);  // all but the outermost layer of cells
  for (const std::array<double, 3> slope :
       {std::array<double, 3>{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-3, 0.7, 0.2}}) {
    EXPECT_LT(worst_error(resampler, cfd.centre, mesh.centre, inside, slope), exactness);
  }
}

TEST(Resampler, ReproducesLinearFieldsBetweenRandomClouds) {
  const auto many = random_cloud(3000, 1), some = random_cloud(2000, 2), few = random_cloud(200, 3);
  const auto inside_some = targets_inside(some, many), inside_many = targets_inside(many, few);
  const std::array<double, 3> slope{1, -2, 0.5};

  EXPECT_GT(inside_some.size(), 2000U);
  EXPECT_GT(inside_many.size(), 100U);
  EXPECT_LT(worst_error(Resampler(some, {}, many), some, many, inside_some, slope), exactness);
  EXPECT_LT(worst_error(Resampler(many, {}, few), many, few, inside_many, slope), exactness);
}

TEST(Resampler, ChildrenAverageBackToTheirParent) {
  const auto coarse = field::make_furnace_mesh({}, 4, 6, 5), fine = field::make_furnace_mesh({}, 8, 12, 10);
  // Gently curved, so that no value reaches a limit away from the walls.
  MatrixF values(1, coarse.centre.rows());
  for (Eigen::Index i = 0; i < values.cols(); ++i)
    values(0, i) =
        static_cast<float>(coarse.centre(i, 2) + 0.001 * coarse.centre(i, 1) * coarse.centre(i, 1));
  const auto there = Resampler(coarse.centre, coarse.volume, fine.centre).apply(values);

  for (std::size_t k = 1; k < 4; ++k) {
    for (std::size_t j = 1; j < 5; ++j) {
      for (std::size_t i = 1; i < 3; ++i) {
        double mean = 0;
        for (std::size_t child = 0; child < 8; ++child) {
          mean += there(0, static_cast<Eigen::Index>((2 * k + child / 4) * 96 + (2 * i + child % 2) +
                                                     8 * (2 * j + child / 2 % 2))) /
                  8;
        }
        EXPECT_NEAR(mean, values(0, static_cast<Eigen::Index>(k * 24 + i + 4 * j)), 1e-5 * values.maxCoeff());
      }
    }
  }
}

TEST(Resampler, RealFieldsComeBackAlmostUnchanged) {
  const auto cfd = read_el3d(ELROM_SOURCE_DIR "/data/cases/load_064.h5");
  const auto mesh = field::read_mesh(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5");
  const Resampler there(cfd.centre, cfd.volume, mesh.centre), back(mesh.centre, mesh.volume, cfd.centre);

  const auto errors = round_trip_error(cfd.values, back.apply(there.apply(cfd.values)));

  for (std::size_t f = 0; f < errors.size(); ++f) EXPECT_LT(errors[f], 0.1) << cfd.fields[f].name;
}

TEST(Resampler, NoValueLeavesTheRangeOfItsSource) {
  const MatrixD source = random_cloud(500, 5), target = random_cloud(4000, 6) * 2;
  base::Random random{base::Seed(7)};
  MatrixF values(1, 500);
  for (Eigen::Index i = 0; i < 500; ++i)
    values(0, i) = static_cast<float>(std::pow(10.0, random.uniform(-6, 0)));

  const auto result = Resampler(source, {}, target).apply(values);

  EXPECT_GE(result.minCoeff(), values.minCoeff());
  EXPECT_LE(result.maxCoeff(), values.maxCoeff());
}

TEST(Resampler, OnTheSameMeshNothingChanges) {
  const auto mesh = field::make_furnace_mesh({}, 3, 4, 5);
  MatrixF values = MatrixF::Random(2, mesh.centre.rows());

  EXPECT_EQ(Resampler(mesh.centre, mesh.volume, mesh.centre).apply(values), values);
}

TEST(Resampler, ACoarseTargetTakesTheVolumeWeightedMean) {
  const MatrixD source{{0, 0, 0}, {1, 0, 0}, {10, 0, 0}}, target{{0.75, 0, 0}, {10, 0, 0}};
  const MatrixF values{{2, 6, 1}};

  const auto result = Resampler(source, std::vector<double>{1, 3, 1}, target).apply(values);

  EXPECT_NEAR(result(0, 0), 5, 1e-5);  // (2 + 3 * 6) / 4, at the mean centre of its parents
  EXPECT_EQ(result(0, 1), 1);
}

TEST(Resampler, MirroredFieldsResampleToMirroredFields) {
  const auto coarse = field::make_furnace_mesh({}, 5, 6, 4), fine = field::make_furnace_mesh({}, 10, 12, 8);
  const auto flip = [](const MatrixF& f, Eigen::Index n_x, Eigen::Index n_y) {
    MatrixF mirrored(f.rows(), f.cols());
    for (Eigen::Index c = 0; c < f.cols(); ++c) {
      const auto i = c % n_x, j = c / n_x % n_y, k = c / (n_x * n_y);
      mirrored(0, c) = f(0, (n_x - 1 - i) + n_x * (j + n_y * k));
    }
    return mirrored;
  };
  const MatrixF values = MatrixF::Random(1, coarse.centre.rows());
  const Resampler there(coarse.centre, coarse.volume, fine.centre);

  const MatrixF difference = there.apply(flip(values, 5, 6)) - flip(there.apply(values), 10, 12);

  EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-5);
}

TEST(Resampler, DegenerateSourcesStayFinite) {
  const auto target = random_cloud(50, 8);
  MatrixD plane = random_cloud(100, 9), line = random_cloud(30, 10), point = random_cloud(1, 11),
          twins = random_cloud(20, 12);
  plane.col(2).setConstant(1);
  line.rightCols(2).setZero();
  twins.bottomRows(10) = twins.topRows(10);

  for (const auto& source : {plane, line, point, twins}) {
    const auto result = Resampler(source, {}, target).apply(linear_field(source, {1, 1, 1}));
    EXPECT_TRUE(result.allFinite());
  }
  EXPECT_ERROR(InputError, "without cells", Resampler(MatrixD(0, 3), {}, target));
}

TEST(Resampler, DoesNotDependOnTheNumberOfThreads) {
  const auto source = random_cloud(800, 13), target = random_cloud(900, 14);
  const MatrixF values = MatrixF::Random(1, 800);

  EXPECT_EQ(Resampler(source, {}, target, 1).apply(values), Resampler(source, {}, target, 3).apply(values));
}

TEST(RoundTripError, IsRelativeToTheFieldsOwnDeviation) {
  const MatrixF original{{1, -1, 1, -1}, {5, 5, 5, 5}, {0, 0, 0, 0}};
  const MatrixF back{{1.1F, -1.1F, 0.9F, -0.9F}, {4, 6, 4, 6}, {0, 0, 0, 0}};

  const auto errors = round_trip_error(original, back);

  EXPECT_NEAR(errors[0], 0.1, 1e-6);
  EXPECT_NEAR(errors[1], 0.2, 1e-6);
  EXPECT_EQ(errors[2], 0);
}

}  // namespace
}  // namespace elrom::ingest
