#include "field_stage.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "support/fake_method.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::study {
namespace {

TEST(FieldStage, IntervalsAreThoseOfTheBlendThatAnswers) {
  const field::CaseSet cases = test::toy_cases(10);
  const field::FieldData data = test::toy_field(cases);
  const MatrixF left_errors = 1.1F * test::lopsided(data, "a", 0.1F),
                right_errors = test::lopsided(data, "b", 10);
  const test::FakeMethod left("left", left_errors), right("right", right_errors);

  const FieldStage stage = fit_field(
      {.name = "auto", .candidates = {&left, &right}, .data = data, .band_edges = {0.3}, .n_folds = 4},
      io::StageCache(), {});

  std::vector<std::int32_t> planes(cases.mesh.n_planes);
  std::iota(planes.begin(), planes.end(), 0);
  std::vector<float> scale(cases.mesh.n_cells());
  stage.uncertainty()->scale(planes, scale);
  const std::size_t n_columns = cases.mesh.n_columns;
  double of_left = 0, of_right = 0;  // root mean squares over each half
  for (std::size_t c = 0; c < scale.size(); ++c)
    (c % n_columns < n_columns / 2 ? of_left : of_right) += scale[c] * scale[c] / (scale.size() / 2.0);
  EXPECT_NEAR(std::sqrt(of_left), 0.011, 0.002);  // the left method's errors in its own half
  EXPECT_NEAR(std::sqrt(of_right), 0.01, 0.002);
}

/// Predicts the truth, and remembers into how many folds the cases were cut each time.
class Counting final : public methods::Method {
 public:
  [[nodiscard]] std::string name() const override { return "counting"; }
  [[nodiscard]] std::string key(const std::string&) const override { return name(); }
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const methods::FitContext& context) const override {
    return methods::make_peer("nearest")->fit(data, cases, context);
  }
  [[nodiscard]] MatrixF predict_folds(const field::FieldData& data, const methods::Folds& folds,
                                      std::span<const std::size_t>,
                                      const methods::FitContext&) const override {
    n_folds.push_back(folds.size());
    return 0.9F * data.values;
  }
  mutable std::vector<std::size_t> n_folds;
};

TEST(FieldStage, FewCasesAreLeftOutFewAtATimeForTheIntervals) {
  for (const std::size_t n_cases : {127U, 128U}) {
    const field::CaseSet cases = test::toy_cases(n_cases);
    const field::FieldData data = test::toy_field(cases);
    const Counting method;

    (void)fit_field({.name = "auto", .candidates = {&method}, .data = data, .band_edges = {}, .n_folds = 4},
                    io::StageCache(), {});

    const std::size_t for_intervals = n_cases < 128 ? 8 : 4;
    EXPECT_EQ(method.n_folds, (std::vector<std::size_t>{4, for_intervals}));
  }
}

}  // namespace
}  // namespace elrom::study
