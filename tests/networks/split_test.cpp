#include "elrom/networks/split.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace elrom::networks {
namespace {

const std::vector<double> fractions{0.7, 0.2, 0.1};

std::vector<double> rising_loads(std::size_t n) {
  std::vector<double> loads(n);
  for (std::size_t i = 0; i < n; ++i) loads[i] = 0.4 + 0.01 * static_cast<double>((i * 37) % n);
  return loads;
}

TEST(Split, CountsFollowTheFractions) {
  const auto parts = split_cases(rising_loads(200), fractions, base::Seed(1));

  EXPECT_EQ(std::ranges::count(parts, Part::train), 140);
  EXPECT_EQ(std::ranges::count(parts, Part::validation), 40);
  EXPECT_EQ(std::ranges::count(parts, Part::test), 20);
}

TEST(Split, EveryPartSpansTheLoads) {
  const auto loads = rising_loads(200);

  const auto parts = split_cases(loads, fractions, base::Seed(5));

  for (const Part part : {Part::train, Part::validation, Part::test}) {
    double sum = 0, n = 0;
    for (std::size_t i = 0; i < loads.size(); ++i)
      if (parts[i] == part) sum += loads[i], ++n;
    EXPECT_NEAR(sum / n, 0.4 + 0.01 * 99.5, 0.06) << "strata of ten cases keep the mean load of each part";
  }
}

TEST(Split, SameSeedSameSplitOtherSeedAnother) {
  const auto loads = rising_loads(60);

  EXPECT_EQ(split_cases(loads, fractions, base::Seed(3)), split_cases(loads, fractions, base::Seed(3)));
  EXPECT_NE(split_cases(loads, fractions, base::Seed(3)), split_cases(loads, fractions, base::Seed(4)));
}

TEST(Split, FewCasesStillFillEveryPart) {
  const auto three = split_cases(rising_loads(3), fractions, base::Seed(1));
  const auto two = split_cases(std::vector<double>{NAN, 0.5}, fractions, base::Seed(1));

  EXPECT_THAT(three, ::testing::UnorderedElementsAre(Part::train, Part::validation, Part::test));
  EXPECT_THAT(two, ::testing::UnorderedElementsAre(Part::train, Part::validation));
}

TEST(Split, ByCaseKeepsThePlanesOfACaseTogether) {
  const auto records = split_records(rising_loads(20), 7, {}, base::Seed(1));

  for (std::size_t r = 0; r < records.size(); ++r) EXPECT_EQ(records[r], records[r - r % 7]);
}

TEST(Split, ByRecordSpreadsTheCasesOverTheParts) {
  SplitSettings settings;
  settings.by = "record";

  const auto records = split_records(rising_loads(20), 50, part_rule(settings), base::Seed(1));

  EXPECT_EQ(std::ranges::count(records, Part::train), 700);
  for (std::size_t i_case = 0; i_case < 20; ++i_case) {
    const std::span<const Part> of_case(&records[i_case * 50], 50);
    EXPECT_GT(std::ranges::count(of_case, Part::validation), 0);
  }
}

std::vector<std::vector<Part>> all_builds(std::size_t n_cases, std::size_t n_builds,
                                          const PartRule& rule = {}, std::size_t n_planes = 1) {
  std::vector<std::vector<Part>> builds;
  for (std::size_t i = 0; i < n_builds; ++i)
    builds.push_back(build_parts(rising_loads(n_cases), n_planes, rule, base::Seed(1), {i, n_builds}));
  return builds;
}

TEST(BuildParts, EveryCaseStopsOneBuildAndIsLearnedFromByTheOthers) {
  const auto builds = all_builds(23, 10);

  for (std::size_t i = 0; i < 23; ++i) {
    EXPECT_EQ(std::ranges::count_if(builds, [&](const auto& parts) { return parts[i] == Part::validation; }),
              1);
    EXPECT_EQ(std::ranges::count_if(builds, [&](const auto& parts) { return parts[i] == Part::train; }), 9);
  }
}

TEST(BuildParts, FewBuildsStopOnNoMoreThanTheRulesShare) {
  for (const auto& parts : all_builds(40, 2)) EXPECT_EQ(std::ranges::count(parts, Part::validation), 8);
  const auto builds = all_builds(40, 2);
  EXPECT_NE(builds[0], builds[1]);
}

TEST(BuildParts, AFoldSpansTheLoads) {
  const auto loads = rising_loads(200);
  for (const auto& parts : all_builds(200, 5)) {
    double sum = 0;
    for (std::size_t i = 0; i < loads.size(); ++i) sum += parts[i] == Part::validation ? loads[i] : 0;
    EXPECT_NEAR(sum / 40, 0.4 + 0.01 * 99.5, 0.06);
  }
}

TEST(BuildParts, ByCaseAndByRecord) {
  for (const auto& parts : all_builds(20, 5, {}, 7))
    for (std::size_t r = 0; r < parts.size(); ++r) EXPECT_EQ(parts[r], parts[r - r % 7]);
  SplitSettings by_record;
  by_record.by = "record";
  for (const auto& parts : all_builds(20, 5, part_rule(by_record), 50))
    for (std::size_t i = 0; i < 20; ++i)
      EXPECT_GT(std::ranges::count(std::span(&parts[i * 50], 50), Part::validation), 0) << i;
}

TEST(BuildParts, NoneStopsWhereTheRuleHasNoSuchPartOrThereIsOneCase) {
  SplitSettings all;
  all.fractions = {0.9, 0, 0.1};
  EXPECT_EQ(std::ranges::count(all_builds(20, 5, part_rule(all))[0], Part::validation), 0);
  EXPECT_THAT(all_builds(1, 5)[3], ::testing::ElementsAre(Part::train));
  EXPECT_THAT(all_builds(2, 5)[3], ::testing::UnorderedElementsAre(Part::train, Part::validation))
      << "no more folds than cases";
}

}  // namespace
}  // namespace elrom::networks
