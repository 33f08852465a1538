#include "fundamental_domain.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "elrom/math/statistics.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::methods {
namespace {

const std::vector<SymmetryClass>& four_classes() {
  static const auto classes = symmetry_classes(2);
  return classes;
}

MatrixF whole(const FundamentalDomain& domain, std::size_t i_class, const MatrixF& part) {
  MatrixF cells = MatrixF::Zero(part.rows(), static_cast<Eigen::Index>(domain.n_all_cells()));
  domain.add(i_class, part, cells, 2);
  return cells;
}

class OfParity : public ::testing::TestWithParam<field::Parity> {};
INSTANTIATE_TEST_SUITE_P(FundamentalDomain, OfParity,
                         ::testing::Values(field::Parity::scalar, field::Parity::vector_x,
                                           field::Parity::vector_y));

TEST_P(OfParity, ProjectionsAddUpAndAreOrthogonal) {
  const field::CaseSet cases = test::toy_cases(3);
  const field::FieldData data = test::toy_field(cases, 0.3);
  const FundamentalDomain domain(cases, GetParam(), four_classes());
  MatrixF sum = MatrixF::Zero(3, data.values.cols());
  std::vector<MatrixF> parts;

  for (std::size_t c = 0; c < 4; ++c) {
    const MatrixF part = domain.project(data.values, math::all_rows(3), c, 1);
    EXPECT_EQ(part.cols(), 8 * 6);
    parts.push_back(whole(domain, c, part));
    sum += parts.back();
    // Sums over the domain are those over all cells.
    EXPECT_TRUE((part * part.transpose()).isApprox(parts[c] * parts[c].transpose(), 1e-4F)) << c;
  }

  EXPECT_TRUE(sum.isApprox(data.values, 1e-6F));
  EXPECT_NEAR((parts[0] * parts[2].transpose()).cwiseAbs().maxCoeff(), 0, 1e-4F * data.values.squaredNorm());
}

TEST_P(OfParity, AProjectionIsWhatTheMirrorsKeepOrNegate) {
  const field::CaseSet cases = test::toy_cases(3);
  const field::FieldData data = test::toy_field(cases, 0.3);
  const FundamentalDomain domain(cases, GetParam(), four_classes());
  for (std::size_t c = 0; c < 4; ++c) {
    const MatrixF cells = whole(domain, c, domain.project(data.values, math::all_rows(3), c, 1));
    for (std::size_t k = 0; k < 2; ++k) {
      const auto& mirror = cases.mirrors[k];
      const auto sign = static_cast<float>(four_classes()[c].signs[k] * mirror.field_sign(GetParam()));
      EXPECT_TRUE(MatrixF(sign * cells(Eigen::all, mirror.cell_from)).isApprox(cells, 1e-5F)) << c << k;
    }
  }
}

TEST_P(OfParity, FactorsLearnedOnTheDomainAreThoseOfAllCells) {
  const field::CaseSet cases = test::toy_cases(20);
  const field::FieldData truth = test::toy_field(cases), found = test::toy_field(cases, 2);
  const FundamentalDomain domain(cases, GetParam(), four_classes());
  for (const std::size_t c : {0, 1, 3}) {
    const auto rows = math::all_rows(20);
    MatrixF part = domain.project(found.values, rows, c, 1), cells = whole(domain, c, part);
    const MatrixF true_part = domain.project(truth.values, rows, c, 1),
                  true_cells = whole(domain, c, true_part);
    const bool spectral = c == 0;
    Shrinkage on_domain(domain.box(c)), everywhere(box_of(cases.mesh));

    on_domain.learn(part, true_part, {.spectral = spectral}, 2);
    everywhere.learn(cells, true_cells, {.spectral = spectral}, 2);

    EXPECT_FALSE(part.isApprox(domain.project(found.values, rows, c, 1), 1e-3F));
    EXPECT_TRUE(whole(domain, c, part).isApprox(cells, 1e-4F)) << c;
  }
}

TEST(FundamentalDomain, WindowsGoOnInTheMirror) {
  Eigen::VectorXd half(4), whole(8);
  half << 1, 5, 2, 7;
  whole << half, half.reverse();

  const auto sums = window_sums(half, {{1, 1, 4}, {false, false, true}}, {0, 0, 2});

  EXPECT_EQ(sums, window_sums(whole, {{1, 1, 8}}, {0, 0, 2}).head(4));
  EXPECT_EQ(sums[3], 5 + 2 + 7 + 7 + 2);
}

TEST(FundamentalDomain, IsAllCellsWhereMirrorsLeaveNoQuarter) {
  auto plain = test::toy_cases(2, false), across = test::toy_cases(2), odd = test::toy_cases(2);
  std::ranges::reverse(across.mirrors.back().cell_from);  // upside down
  odd.mesh = field::make_furnace_mesh({}, 5, 6, 8);       // columns on a mirror are their own images
  odd.mirrors = {field::resolve({"front-rear", 'x', {{"*_front_*", "*_rear_*"}}, {}}, odd.schema, odd.mesh)};
  for (const auto* cases : {&plain, &across, &odd}) {
    const auto classes = symmetry_classes(cases->mirrors.size());
    const FundamentalDomain domain(*cases, field::Parity::vector_x, classes);
    MatrixF values = MatrixF::Random(2, static_cast<Eigen::Index>(cases->mesh.n_cells())),
            sum = MatrixF::Zero(2, values.cols());

    for (std::size_t c = 0; c < classes.size(); ++c)
      domain.add(c, domain.project(values, math::all_rows(2), c, 1), sum, 1);

    EXPECT_EQ(domain.n_cells(), domain.n_all_cells());
    EXPECT_EQ(domain.keeps_planes(), cases != &across);
    EXPECT_EQ(domain.box(0)->mirrored, (std::array<bool, 3>{}));
    EXPECT_TRUE(sum.isApprox(values, 1e-6F));
  }
}

TEST(FundamentalDomain, OfOneMirrorIsHalfOfTheBox) {
  auto cases = test::toy_cases(2);
  cases.mirrors.pop_back();  // left-right stays
  const FundamentalDomain domain(cases, field::Parity::vector_y, symmetry_classes(1));

  const auto symmetric = domain.box(0), antisymmetric = domain.box(1);

  EXPECT_EQ(symmetric->sizes, (std::array<std::size_t, 3>{8, 3, 4}));
  EXPECT_EQ(symmetric->mirrored, (std::array{false, true, false}));
  EXPECT_EQ(symmetric->beyond[1], math::Beyond::negative);  // a velocity through the mirror
  EXPECT_EQ(antisymmetric->beyond[1], math::Beyond::same);
}

}  // namespace
}  // namespace elrom::methods
