#include "elrom/surrogate/learn_chebyshev.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"

namespace elrom::surrogate {
namespace {

using particle::FrameRecords;
using particle::Table;

/// Records of a function of angle and speed, spread evenly over [0, 1] x [0.1, 0.3].
FrameRecords records_of(const std::function<double(double, double)>& f, Eigen::Index n = 3000) {
  base::Random random(base::Seed(3));
  FrameRecords records{Table(n, 2), Table(n, 3), Eigen::ArrayXd::Constant(n, 2.0)};
  for (Eigen::Index i = 0; i < n; ++i) {
    records.inputs(i, 0) = random.uniform();
    records.inputs(i, 1) = random.uniform(0.1, 0.3);
    records.targets.row(i) = f(records.inputs(i, 0), records.inputs(i, 1));
  }
  return records;
}

double greatest_error(const particle::Chebyshev& model, const FrameRecords& records) {
  Table outputs(records.inputs.rows(), 3);
  model.evaluate(records.inputs, outputs);
  return (outputs - records.targets).abs().maxCoeff();
}

TEST(LearnChebyshev, FindsAPolynomialExactly) {
  const auto records = records_of([](double x, double y) { return 1 + x * x * x - 5 * y * y + 7 * x * y; });
  EXPECT_LT(greatest_error(*learn_chebyshev(records), records), 1e-7);
}

// Friction makes such kinks: panels are halved around them until little of it is left.
TEST(LearnChebyshev, PutsPanelsWhereAKinkIs) {
  const auto records = records_of([](double x, double) { return std::min(x, 0.37); }, 20000);
  const auto one = learn_chebyshev(records, {.most_panels = 1}), many = learn_chebyshev(records);
  EXPECT_GT(many->n_panels(), 3u);
  EXPECT_LT(greatest_error(*many, records), greatest_error(*one, records) / 20);
}

// Fast pairs count more: of two answers at one place the faster one's wins.
TEST(LearnChebyshev, RecordsWeighByTheirSpeed) {
  auto records = records_of([](double, double) { return 0.0; });
  for (Eigen::Index i = 0; i < records.inputs.rows(); i += 2) {
    records.targets.row(i) = 1;
    records.speed[i] = 200;
  }
  Table outputs(records.inputs.rows(), 3);
  learn_chebyshev(records, {.degree_x = 0, .degree_y = 0, .most_panels = 1})
      ->evaluate(records.inputs, outputs);
  EXPECT_NEAR(outputs(0, 0), 1, 1e-3);
}

TEST(LearnChebyshev, SaysWhenRecordsAreTooFew) {
  EXPECT_THROW((void)learn_chebyshev(records_of([](double, double) { return 0.0; }, 20)), InputError);
}

}  // namespace
}  // namespace elrom::surrogate
