#include "summary.hpp"

#include <gmock/gmock.h>

#include "elrom/base/text.hpp"

namespace elrom::fields {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A base, and two cases that a sweep of air in t/h made of it, in kg/s inside.
class SweptSummary : public ::testing::Test {
 protected:
  SweptSummary() {
    for (const double air : {10.0, 20.0, 30.0})
      list_.cases.push_back({.name = "air_" + base::number(air), .load = 0.5, .values = {air, 1, 2}});
    list_.origins = {{0, {}}, {0, {0}}, {0, {0}}};
    list_.swept = {{0, &base::unit("t/h")}};
    for (const double solids : {5.0, 5.5, 6.0})
      results_.push_back({.reason = "as good as trained", .figures = {solids}, .unusual_audit = {}});
  }
  [[nodiscard]] Summary summary() const { return {schema_, list_, names_, results_}; }
  [[nodiscard]] std::string cell(std::size_t line, std::string_view heading) const {
    const auto lines = base::split(summary_table(summary()), '\n');
    const auto headings = base::split(lines[0], ',');
    const auto column = std::ranges::find(headings, heading) - headings.begin();
    return base::split(lines[line], ',')[static_cast<std::size_t>(column)];
  }

  const field::InputSchema schema_{{{"air", "kg/s", "kg/s"}, {"fuel", "kg/s", "kg/s"}, {"heat", "W", "W"}}};
  const std::vector<std::string> names_{"solids [kg]"};
  CaseList list_;
  std::vector<CaseResult> results_;
};

TEST_F(SweptSummary, SaysWhatIsHeldAndWhere) {
  EXPECT_EQ(cell(1, "held"), "");
  EXPECT_EQ(cell(3, "held"), "2 other inputs at the values of air_10");
  EXPECT_THAT(curves_page(summary(), std::vector<std::size_t>{0}),
              HasSubstr("Inputs that are not swept are held at the base's values."));
}

TEST_F(SweptSummary, ShowsASweepInTheUnitThatItWasGivenIn) {
  EXPECT_EQ(cell(3, "air [t/h]"), "108");
  EXPECT_THAT(curves_page(summary(), std::vector<std::size_t>{0}), HasSubstr("air [t/h]"));
}

TEST_F(SweptSummary, AnAuditThatOnlyASweepMakesUnusualIsCalledSo) {
  results_[2].unusual_audit = {"gas flow over the inlets' is 0.8: 0.99 +- 0.02 in 64 training cases"};
  EXPECT_EQ(n_held_alone(summary()), 1U);
  EXPECT_THAT(cell(3, "reason"), HasSubstr("64 training cases; only since the other inputs were held"));
  EXPECT_THAT(cell(2, "reason"), Not(HasSubstr("held")));
  EXPECT_THAT(curves_page(summary(), std::vector<std::size_t>{0}),
              HasSubstr("In 1 of the cases mass or pressure are unlike the training cases'"));

  results_[0].unusual_audit = results_[2].unusual_audit;
  EXPECT_EQ(n_held_alone(summary()), 0U) << "the base has it too";
  EXPECT_THAT(cell(3, "reason"), Not(HasSubstr("only since")));
}

}  // namespace
}  // namespace elrom::fields
