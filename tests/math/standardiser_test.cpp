#include "elrom/math/standardiser.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace elrom::math {
namespace {

TEST(Standardiser, UndoIsTheInverse) {
  MatrixD rows(3, 2);
  rows << 1, -5e6, 2, 1e6, 6, 4e6;
  const Standardiser scaler(rows);

  const MatrixD back = scaler.undo(scaler.apply(rows));

  EXPECT_TRUE(back.isApprox(rows, 1e-14)) << back << "\n\n" << rows;
}

TEST(Standardiser, GivesZeroMeanAndUnitDeviation) {
  MatrixD rows(2, 1);
  rows << 3, 7;

  const MatrixD scaled = Standardiser(rows).apply(rows);

  EXPECT_DOUBLE_EQ(scaled(0, 0), -1);
  EXPECT_DOUBLE_EQ(scaled(1, 0), 1);
}

TEST(Standardiser, TurnsAConstantColumnToZero) {
  const MatrixD rows =
      MatrixD::Constant(5, 1, 0.1);  // not exact in binary: its deviation is rounding, not zero
  const Standardiser scaler(rows);

  EXPECT_EQ(scaler.scale()[0], 1);
  EXPECT_NEAR(scaler.apply(rows).cwiseAbs().maxCoeff(), 0, 1e-15);
}

TEST(Standardiser, SingleRowAgreesWithTable) {
  MatrixD rows(3, 2);
  rows << 1, 2, 3, 5, 8, 13;
  const Standardiser scaler(rows);
  std::vector<double> out(2);

  scaler.apply(std::vector<double>{3, 5}, out);

  EXPECT_DOUBLE_EQ(out[0], scaler.apply(rows)(1, 0));
  EXPECT_DOUBLE_EQ(out[1], scaler.apply(rows)(1, 1));
}

}  // namespace
}  // namespace elrom::math
