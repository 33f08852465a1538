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

}  // namespace
}  // namespace elrom::study
