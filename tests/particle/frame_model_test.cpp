#include "elrom/particle/frame_model.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "elrom/particle/chebyshev.hpp"
#include "elrom/particle/exact_model.hpp"
#include "elrom/particle/pair_solver.hpp"
#include "particle/pairs_for_tests.hpp"

namespace elrom::particle {
namespace {

using test::after;
using test::energy;
using test::one_pair;
using test::row;
using test::Vector;

const ContactLaw rough{.restitution = 0.9, .friction = 0.3, .stiffness = 1e6};

/// A regressor by hand: what hard spheres of the law do, or noise.
class ByHand final : public Regressor {
 public:
  using Function = std::function<void(const double* inputs, double* outputs)>;
  ByHand(std::size_t n_inputs, std::size_t n_outputs, Function function)
      : n_inputs_(n_inputs), n_outputs_(n_outputs), function_(std::move(function)) {}
  std::string kind() const override { return "by hand"; }
  std::size_t n_inputs() const override { return n_inputs_; }
  std::size_t n_outputs() const override { return n_outputs_; }
  void evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const override {
    for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
      const Eigen::VectorXd x = inputs.row(i).matrix().transpose();
      Eigen::VectorXd y(outputs.cols());
      function_(x.data(), y.data());
      outputs.row(i) = y.transpose().array();
    }
  }
  void write(io::TensorFile&, const std::string&) const override {}

 private:
  std::size_t n_inputs_, n_outputs_;
  Function function_;
};

// j_n = (1+e) cos, j_t = min(mu j_n, 2/7 (1+b) sin), with the tangent c / v_n from the angle c / (v_n + c).
FrameModel hard_spheres() {
  return {rough,
          std::make_shared<ByHand>(2, 3,
                                   [](const double* x, double* y) {
                                     const double norm = std::hypot(1 - x[0], x[0]);
                                     y[0] = 1.9 * (1 - x[0]) / norm;
                                     y[1] = y[2] = std::min(0.3 * y[0], 2.0 / 7 * 1.9 * x[0] / norm);
                                   }),
          10};
}

TEST(FrameModel, PutsImpulsesWhereTheExactModelDoes) {
  const auto pairs = draw_pairs({.diameter_2 = {400e-6, 500e-6}, .density_2 = 2500}, 9, 0, 517);
  const auto hard = after(hard_spheres(), pairs), exact = after(ExactModel(rough), pairs);
  EXPECT_LT((hard.velocity_1 - exact.velocity_1).abs().maxCoeff(), 1e-12);
  EXPECT_LT((hard.velocity_2 - exact.velocity_2).abs().maxCoeff(), 1e-12);
  EXPECT_LT((hard.spin_1 - exact.spin_1).abs().maxCoeff(), 1e-6);
  EXPECT_LT((hard.spin_2 - exact.spin_2).abs().maxCoeff(), 1e-6);
}

// Records of a set are what the model gives back: the regressor that returns them gives the set's motion.
TEST(FrameModel, RecordsAndImpulsesAreInverse) {
  for (const bool spins : {false, true}) {
    const auto pairs =
        draw_pairs({.diameter_2 = {475e-6, 475e-6}, .spin_speed = spins ? 5.0 : 0.0}, 9, 0, 40);
    const auto truth = collide(pairs, rough).after;
    const auto records = frame_records(pairs, truth, rough, spins);
    Eigen::Index next = 0;
    const auto replay = std::make_shared<ByHand>(spins ? 5 : 2, spins ? 5 : 3, [&](const double*, double* y) {
      for (Eigen::Index k = 0; k < records.targets.cols(); ++k)
        y[k] = records.targets(std::min<Eigen::Index>(next, 39), k);
      ++next;
    });
    const auto found = after(FrameModel(rough, replay, 10), pairs);
    // Without spins nothing points beside; what soft contacts do in the plane is all there is.
    EXPECT_LT((found.velocity_1 - truth.velocity_1).abs().maxCoeff(), 1e-9) << spins;
    const Components surface = (found.spin_1 - truth.spin_1) * 157e-6;
    EXPECT_LT(surface.abs().maxCoeff(), spins ? 0.2 : 1e-9) << spins;
  }
}

// Of the sizes and masses only two dimensionless numbers are left (frame_model.hpp).
TEST(FrameModel, OneSetOfRecordsServesAllSizesOfALaw) {
  for (const auto kind : {LawKind::linear, LawKind::hertz}) {
    const ContactLaw law{.kind = kind, .friction = 0.3, .stiffness = 1e5};
    const auto small = one_pair({5, 3, 0}, {0, 0, 0}, {1, 0, 0}, 300e-6, 300e-6);
    const Ball ball{300e-6, 1000}, one{500e-6, 2500}, two{900e-6, 700};
    // The speed at which the other pair has the same dimensionless speed, by the law's own greatest overlap.
    const auto share = [&](double speed, const Ball& a, const Ball& b) {
      const PairContact contact(law, a, b);
      return contact.greatest_overlap(speed) / contact.distance;
    };
    double low = 1e-3, high = 1e4;
    for (int i = 0; i < 200; ++i) {
      const double middle = std::sqrt(low * high);
      (share(middle, one, two) < share(1, ball, ball) ? low : high) = middle;
    }
    auto large = one_pair(low * Vector(5, 3, 0), {0, 0, 0}, {1, 0, 0}, one.diameter, two.diameter,
                          one.density, two.density);
    const auto a = frame_records(small, collide(small, law).after, law, false);
    const auto b = frame_records(large, collide(large, law).after, law, false);
    EXPECT_LT((a.inputs - b.inputs).abs().maxCoeff(), 1e-9) << law_names.name(kind);
    EXPECT_LT((a.targets - b.targets).abs().maxCoeff(), 1e-5) << law_names.name(kind);
  }
}

/// Answers nobody could have learned.
FrameModel noise(double restitution, double size) {
  const auto random = std::make_shared<base::Random>(base::Seed(4));
  return {{.restitution = restitution, .friction = 0.3, .stiffness = 1e6},
          std::make_shared<ByHand>(5, 5,
                                   [=](const double*, double* y) {
                                     for (int k = 0; k < 5; ++k) y[k] = random->uniform(-size, size);
                                   }),
          10};
}

TEST(FrameModel, NeverGainsEnergyWhateverTheRegressorSays) {
  for (const double size : {0.1, 2.0, 1e6}) {
    const auto pairs =
        draw_pairs({.diameter_2 = {50e-6, 5e-3}, .density_2 = 9000, .spin_speed = 30}, 9, 0, 20000);
    const Scalars before = energy(pairs, pairs.before), left = energy(pairs, after(noise(1, size), pairs));
    EXPECT_LE(((left - before) / before).maxCoeff(), 1e-13) << size;
  }
}

TEST(FrameModel, ConservesMomentumWhateverTheRegressorSays) {
  const auto pairs = draw_pairs({.spin_speed = 30}, 9, 0, 2000);
  Impulses impulses(2000);
  noise(1, 2).impulses(pairs, impulses);
  EXPECT_TRUE((impulses.linear_1 == -impulses.linear_2).all());
  EXPECT_GT(impulses.linear_1.abs().maxCoeff(), 0);
}

TEST(FrameModel, HardCasesEndInNumbers) {
  const auto model = hard_spheres();
  for (const double speed : {0.0, 5e-324, 1e-310, 1e-160, 1e-9, 1e3, 1e160, double(NAN), double(INFINITY)})
    for (const double along : {0.0, 1e-310, 1e-9, 1e3, double(NAN)})
      for (const double density : {1e-6, 1000.0, 1e9}) {
        const auto pairs = one_pair({speed, along, 0}, {0, 0, 0}, {1, 0, 0}, 315e-6, 475e-6, 1000, density);
        Impulses impulses(1);
        model.impulses(pairs, impulses);
        EXPECT_TRUE(impulses.linear_1.allFinite() && impulses.angular_1.allFinite()) << speed << " " << along;
      }
}

TEST(FrameModel, FasterPairsCountAsTheFastestLearned) {
  const auto seen = std::make_shared<double>(0);
  const FrameModel model(rough,
                         std::make_shared<ByHand>(2, 3,
                                                  [=](const double* x, double* y) {
                                                    *seen = std::max(*seen, x[1]);
                                                    y[0] = 1, y[1] = y[2] = 0;
                                                  }),
                         0.05);
  (void)after(model, one_pair({1e5, 0, 0}, {0, 0, 0}, {1, 0, 0}));
  EXPECT_EQ(*seen, 0.05);
}

TEST(FrameModel, RefusesARegressorOfAnotherSize) {
  const auto other = std::make_shared<ByHand>(3, 3, [](const double*, double*) {});
  EXPECT_THROW(FrameModel(rough, other, 1), InputError);
  const auto fits = std::make_shared<ByHand>(2, 3, [](const double*, double*) {});
  EXPECT_THROW(FrameModel(rough, fits, 0), InputError);
  EXPECT_THROW(FrameModel(rough, fits, NAN), InputError);
}

// 3 m/s towards each other, 4 m/s across: U = 5, angle 4 / 7; orbit 4 / 5 along the slip.
TEST(FrameModel, RecordsHoldSpeedAngleAndOrbit) {
  const auto pairs = one_pair({3, 0, 0}, {0, 4, 0}, {1, 0, 0});
  const auto records = frame_records(pairs, collide(pairs, rough).after, rough, true);
  EXPECT_NEAR(records.speed[0], 5, 1e-14);
  EXPECT_NEAR(records.inputs(0, 0), 4.0 / 7, 1e-14);
  EXPECT_NEAR(records.inputs(0, 2), 0.8, 1e-14);
  EXPECT_NEAR(records.inputs(0, 3), 0, 1e-14);
  // Of the second input's square: U sqrt(m12 / K) / R.
  const double m12 = sphere_mass(315e-6, 1000) / 2;
  EXPECT_NEAR(std::pow(records.inputs(0, 1), 2), 5 * std::sqrt(m12 / 1e6) / 315e-6, 1e-12);
}

}  // namespace
}  // namespace elrom::particle
