#include "elrom/networks/records.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "support/toy_furnace.hpp"

namespace elrom::networks {
namespace {

constexpr std::size_t n_cases = 20, n_planes = 8;

std::vector<std::size_t> all_cases() {
  std::vector<std::size_t> rows(n_cases);
  std::iota(rows.begin(), rows.end(), 0);
  return rows;
}

/// The last cases stop or judge, the others train.
std::vector<Part> whole_case_parts(std::size_t n_train) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < n_cases; ++i)
    parts.insert(parts.end(), n_planes,
                 i < n_train  ? Part::train
                 : i % 2 == 0 ? Part::validation
                              : Part::test);
  return parts;
}

/// What a record's column of the toy stands for before it was scaled.
float unscaled_target(const RecordSet& set, std::size_t record, Eigen::Index column) {
  const auto r = static_cast<Eigen::Index>(record);
  const auto row = set.outputs.row(static_cast<std::size_t>(set.records.plane[record]));
  return set.records.targets(r, column) * set.outputs.deviation(row, column) + set.outputs.mean(row, column);
}

TEST(Records, TargetsAreStandardisedColumnByColumn) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const auto set = make_records({data, all_cases()}, whole_case_parts(14), {});

  ASSERT_EQ(set.records.rows(Part::train).size(), 14 * n_planes);
  for (const auto& column : set.records.targets.colwise()) {
    EXPECT_NEAR(column.cast<double>().mean(), 0, 1e-5);
    EXPECT_NEAR(column.cast<double>().squaredNorm() / (n_cases * n_planes), 1, 1e-4);
  }
}

TEST(Records, EachRecordKnowsItsPlane) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const auto set = make_records({data, all_cases()}, whole_case_parts(14), {});

  std::vector<float> encoding(static_cast<std::size_t>(set.planes.size()));
  const auto n = static_cast<Eigen::Index>(encoding.size());
  for (std::size_t i = 0; i < set.records.plane.size(); ++i) {
    set.planes.encode(static_cast<std::size_t>(set.records.plane[i]), encoding);
    const auto own = set.records.inputs.row(static_cast<Eigen::Index>(i)).tail(n);
    EXPECT_TRUE(std::equal(encoding.begin(), encoding.end(), own.begin())) << "record " << i;
  }
}

TEST(Records, TargetsAreTransformedBeforeTheyAreScaled) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const auto set =
      make_records({data, all_cases()}, whole_case_parts(14), {.transform = model::TransformKind::asinh});

  ASSERT_EQ(set.transform.kind, model::TransformKind::asinh);
  const Eigen::Index plane = set.records.plane[5], case_of = set.records.case_of[5];
  const float value = data.values(case_of, plane * set.records.targets.cols() + 2);
  EXPECT_NEAR(unscaled_target(set, 5, 2), set.transform.apply(value), 1e-4F * (1 + std::abs(value)));
  EXPECT_NE(set.transform.apply(value), value);
}

TEST(RecordSource, DealsAllCasesOutByTheRule) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const RecordRecipe recipe{.options = {}, .parts = {}, .seed = base::Seed(3)};

  const RecordSource source(data, all_cases(), recipe);

  EXPECT_EQ(source.get().records.part, split_records(cases.loads, n_planes, recipe.parts, recipe.seed));
  EXPECT_FALSE(source.get().records.rows(Part::validation).empty());
}

TEST(RecordSource, KnownCasesKeepTheRecordsThatTheyHadWithoutTheOthers) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const std::vector<std::size_t> known{0, 1, 3, 4, 5, 7, 8, 10, 11, 13, 14, 16, 17, 18, 19};
  const RecordRecipe recipe{.options = {.relevance = Relevance::gp}, .parts = {}, .seed = base::Seed(3)};
  auto going_on = recipe;
  going_on.known = known;
  const RecordSource before(data, known, recipe), after(data, all_cases(), going_on);

  EXPECT_EQ(after.get().inputs.factor, before.get().inputs.factor);
  EXPECT_EQ(after.get().inputs.relevance, before.get().inputs.relevance);
  EXPECT_EQ(after.get().outputs.deviation, before.get().outputs.deviation);
  const auto& was = before.get().records;
  const auto& is = after.get().records;
  ASSERT_EQ(is.part.size(), n_cases * n_planes);
  for (std::size_t i = 0; i < known.size(); ++i) {
    const auto first = static_cast<Eigen::Index>(i * n_planes),
               now = static_cast<Eigen::Index>(known[i] * n_planes);
    EXPECT_EQ(is.part[static_cast<std::size_t>(now)], was.part[static_cast<std::size_t>(first)]);
    EXPECT_EQ(is.inputs.middleRows(now, 8), was.inputs.middleRows(first, 8));
    EXPECT_EQ(is.targets.middleRows(now, 8), was.targets.middleRows(first, 8));
  }
  EXPECT_GT(std::ranges::count(is.part, Part::train), std::ranges::count(was.part, Part::train));
  EXPECT_NE(after.key(), RecordSource(data, all_cases(), recipe).key());
}

TEST(Records, ScalersSeeAllCasesOrThoseThatTheyAreGiven) {
  auto cases = test::toy_cases(n_cases);
  auto data = test::toy_field(cases);
  const std::vector<std::size_t> first{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13};
  const RecordOptions options{.relevance = Relevance::gp};
  const auto scaled = [&](std::span<const std::size_t> by) {
    return make_records({data, all_cases()}, whole_case_parts(14), options, by);
  };
  const auto before = scaled(first), whole = scaled({});
  data.values.bottomRows(6) *= 1000;
  auto shifted = cases;
  shifted.inputs.bottomRows(6) *= 7;
  data.cases = &shifted;

  const auto after = scaled(first);

  EXPECT_EQ(after.inputs.mean, before.inputs.mean);
  EXPECT_EQ(after.inputs.factor, before.inputs.factor);
  EXPECT_EQ(after.inputs.relevance, before.inputs.relevance);
  EXPECT_EQ(after.outputs.mean, before.outputs.mean);
  EXPECT_EQ(after.outputs.deviation, before.outputs.deviation);
  EXPECT_NE(scaled({}).outputs.mean, whole.outputs.mean) << "cases that stop or judge are seen too";
}

TEST(RecordSource, EachBuildStopsOnAFoldOfItsOwn) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const RecordRecipe recipe{.options = {}, .parts = {}, .seed = base::Seed(3)};
  const RecordSource source(data, all_cases(), recipe);

  const auto parts = source.parts_of_build({.i_build = 2, .n_builds = 5});

  EXPECT_EQ(parts, build_parts(cases.loads, n_planes, recipe.parts, recipe.seed, {2, 5}));
  const auto problem = make_problem(source.get().records, {.name = "all", .columns = {0}, .mask = {}}, parts);
  EXPECT_EQ(problem.validation_inputs.rows(), 4 * static_cast<Eigen::Index>(n_planes));
  EXPECT_EQ(problem.train_inputs.rows(), 16 * static_cast<Eigen::Index>(n_planes));
}

TEST(Records, AProblemOfABandHasItsColumnsOnly) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const auto set = make_records({data, all_cases()}, whole_case_parts(14), {});
  const Band band{.name = "some", .columns = {3, 11}, .mask = {}};

  const auto problem = make_problem(set.records, band);

  ASSERT_EQ(problem.train_targets.rows(), 14 * static_cast<Eigen::Index>(n_planes));
  ASSERT_EQ(problem.train_targets.cols(), 2);
  EXPECT_EQ(problem.train_weights.size(), 0);
  EXPECT_EQ(problem.train_targets(5, 1), set.records.targets(5, 11));
  EXPECT_EQ(problem.validation_inputs.rows(), 3 * static_cast<Eigen::Index>(n_planes));
}

TEST(Records, AMaskLeavesPlanesOutAndWeighsTheRest) {
  const auto cases = test::toy_cases(n_cases);
  const auto data = test::toy_field(cases);
  const auto set = make_records({data, all_cases()}, whole_case_parts(14), {});
  Band band{.name = "some", .columns = {3, 11}, .mask = std::vector<std::uint8_t>(2 * n_planes, 0)};
  band.mask[2 * 4] = 1;  // plane 4, first column

  const auto problem = make_problem(set.records, band);

  ASSERT_EQ(problem.train_targets.rows(), 14) << "one plane of each case";
  EXPECT_EQ(problem.train_weights.col(0).minCoeff(), 1);
  EXPECT_EQ(problem.train_weights.col(1).maxCoeff(), 0);
}

class RelevanceOf : public ::testing::TestWithParam<Relevance> {};

TEST_P(RelevanceOf, TellsTheInputThatMovesTheFieldFromThoseThatDoNot) {
  base::Random random(base::Seed(8));
  MatrixD inputs(60, 4);
  for (auto& value : inputs.reshaped()) value = random.normal();
  MatrixF values(60, 30);
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    for (Eigen::Index c = 0; c < values.cols(); ++c)
      values(i, c) = static_cast<float>(inputs(i, 2) * (1 + 0.1 * static_cast<double>(c)) +
                                        0.3 * inputs(i, 0) * std::sin(c));

  const auto relevance = relevance_of(GetParam(), inputs, values);

  ASSERT_EQ(relevance.size(), 4U);
  EXPECT_EQ(relevance[2], 1);
  EXPECT_GT(relevance[0], std::max(relevance[1], relevance[3]));
  for (const double one : relevance) {
    EXPECT_GE(one, 0.1);
    EXPECT_LE(one, 1);
  }
}
INSTANTIATE_TEST_SUITE_P(Kinds, RelevanceOf, ::testing::Values(Relevance::linear, Relevance::gp));

TEST(Records, NoRelevanceIsNoList) {
  EXPECT_TRUE(relevance_of(Relevance::none, MatrixD::Random(5, 2), MatrixF::Random(5, 3)).empty());
}

}  // namespace
}  // namespace elrom::networks
