#include "elrom/model/symmetry_fold.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"

namespace elrom::model {
namespace {

using testing::ElementsAre;

/// Two planes of four columns in a 2 x 2 square (column = i_x + 2 i_y), mirrored in x and in y.
std::vector<field::Mirror> square_mirrors() {
  field::Mirror x{.name = "front-rear", .axes = "x"}, y{.name = "left-right", .axes = "y"};
  x.cell_from = {1, 0, 3, 2, 5, 4, 7, 6};
  y.cell_from = {2, 3, 0, 1, 6, 7, 4, 5};
  return {x, y};
}

std::vector<float> unfolded(const SymmetryFold& fold, std::size_t i_class, const std::vector<float>& stored) {
  std::vector<float> column(fold.n_columns(), 0);
  fold.add(i_class, stored, column);
  return column;
}

TEST(SymmetryFold, EachClassSpreadsItsValueWithItsSigns) {
  const SymmetryFold fold(square_mirrors(), field::Parity::scalar, {{1, 1}, {-1, 1}, {1, -1}, {-1, -1}}, 2,
                          4);

  ASSERT_EQ(fold.n_orbits(), 1U);
  EXPECT_THAT(unfolded(fold, 0, {2}), ElementsAre(2, 2, 2, 2));
  EXPECT_THAT(unfolded(fold, 1, {2}), ElementsAre(2, -2, 2, -2));
  EXPECT_THAT(unfolded(fold, 2, {2}), ElementsAre(2, 2, -2, -2));
  EXPECT_THAT(unfolded(fold, 3, {2}), ElementsAre(2, -2, -2, 2));
}

TEST(SymmetryFold, NormalVelocityChangesItsSignInTheSymmetricClass) {
  const SymmetryFold fold(square_mirrors(), field::Parity::vector_x, {{1, 1}}, 2, 4);

  EXPECT_THAT(unfolded(fold, 0, {3}), ElementsAre(3, -3, 3, -3));
}

TEST(SymmetryFold, ColumnsOnTheMirrorCarryNothingOfAnAntisymmetricClass) {
  field::Mirror mirror{.name = "front-rear", .axes = "x"};
  mirror.cell_from = {2, 1, 0};
  const SymmetryFold fold({mirror}, field::Parity::scalar, {{1}, {-1}}, 1, 3);

  ASSERT_EQ(fold.n_orbits(), 2U);
  EXPECT_THAT(unfolded(fold, 0, {5, 7}), ElementsAre(5, 7, 5));
  EXPECT_THAT(unfolded(fold, 1, {5, 7}), ElementsAre(5, 0, -5));
}

TEST(SymmetryFold, PickedValuesSpreadBackToTheSameColumn) {
  const SymmetryFold fold(square_mirrors(), field::Parity::scalar, {{-1, 1}}, 2, 4);
  const std::vector<float> column{4, -4, 4, -4};
  std::vector<float> stored(fold.n_orbits());

  fold.pick(column, stored);

  EXPECT_EQ(unfolded(fold, 0, stored), column);
}

TEST(SymmetryFold, OrbitsHaveTheirColumns) {
  field::Mirror mirror{.name = "front-rear", .axes = "x"};
  mirror.cell_from = {2, 1, 0};

  EXPECT_THAT(SymmetryFold({mirror}, field::Parity::scalar, {{1}}, 1, 3).orbits(),
              ElementsAre(ElementsAre(0, 2), ElementsAre(1)));
  EXPECT_TRUE(SymmetryFold().orbits().empty());
}

TEST(SymmetryFold, MirrorThatExchangesPlanesGivesNoFold) {
  field::Mirror mirror{.name = "up-down", .axes = "x"};
  mirror.cell_from = {2, 3, 0, 1};

  EXPECT_TRUE(SymmetryFold({mirror}, field::Parity::scalar, {{1}}, 2, 2).empty());
}

TEST(SymmetryFold, SurvivesTheFile) {
  const SymmetryFold fold(square_mirrors(), field::Parity::scalar, {{1, 1}, {-1, 1}}, 2, 4);
  io::TensorFile file;
  fold.save(file, "fold");

  const auto loaded = SymmetryFold::load(file, "fold");

  EXPECT_EQ(loaded.n_orbits(), fold.n_orbits());
  EXPECT_EQ(unfolded(loaded, 1, {2}), unfolded(fold, 1, {2}));
  EXPECT_TRUE(SymmetryFold::load(file, "elsewhere").empty());
}

TEST(SymmetryFold, RefusesOrbitsOutOfRange) {
  io::TensorFile file;
  const std::vector<std::int32_t> orbit{0, 2};
  const std::vector<float> sign{1, 1};
  file.set("fold/orbit", io::Tensor::copy(std::span<const std::int32_t>(orbit), {2}));
  file.set("fold/sign", io::Tensor::copy(std::span<const float>(sign), {1, 2}));

  EXPECT_THROW((void)SymmetryFold::load(file, "fold"), InputError);
}

}  // namespace
}  // namespace elrom::model
