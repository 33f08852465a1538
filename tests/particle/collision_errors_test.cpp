#include "elrom/particle/collision_errors.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "elrom/particle/balance.hpp"
#include "pairs_for_tests.hpp"

namespace elrom::particle {
namespace {

using test::Vector;

/// Adds these to the velocities of the spheres, and this to the spin of sphere 1.
class Offset final : public CollisionModel {
 public:
  Offset(Vector one, Vector two, Vector spin_1 = Vector::Zero()) : one_(one), two_(two), spin_1_(spin_1) {}
  [[nodiscard]] SurrogateKind kind() const override { return SurrogateKind::exact; }
  [[nodiscard]] std::string text() const override { return "offset"; }
  void impulses(const Pairs& pairs, Impulses& impulses) const override {
    impulses = Impulses(pairs.size());
    for (Eigen::Index i = 0; i < pairs.diameter_1.size(); ++i) {
      const double m1 = sphere_mass(pairs.diameter_1[i], pairs.density_1[i]);
      const double m2 = sphere_mass(pairs.diameter_2[i], pairs.density_2[i]);
      const double inertia = 0.1 * m1 * pairs.diameter_1[i] * pairs.diameter_1[i];
      impulses.linear_1.row(i) = (m1 * one_).transpose().array();
      impulses.linear_2.row(i) = (m2 * two_).transpose().array();
      impulses.angular_1.row(i) = (inertia * spin_1_).transpose().array();
    }
  }
  void write(io::TensorFile& /*file*/) const override {}

 private:
  Vector one_, two_, spin_1_;
};

/// Head-on along x at 3 and -1 m/s, equal spheres unless said; they leave as they came.
CollisionSet head_on(double density_2 = 1000) {
  const Vector x(1, 0, 0);
  CollisionSet set;
  set.pairs = test::one_pair(3 * x, -x, x, 2e-3, 2e-3, 1000, density_2);
  set.parting.after = set.pairs.before;
  return set;
}

TEST(CollisionErrors, MeanOfBothSpheresByComponent) {
  const auto errors = errors_of(Offset({0.1, -0.2, 0}, {0.3, 0.4, -0.5}), head_on(), 0, 1);
  EXPECT_EQ(errors.n_pairs, 1u);
  EXPECT_NEAR(errors.mae[0], 0.2, 1e-15);
  EXPECT_NEAR(errors.mae[1], 0.3, 1e-15);
  EXPECT_NEAR(errors.mae[2], 0.25, 1e-15);
  EXPECT_NEAR(errors.mae_velocity, 0.25, 1e-15);
  EXPECT_NEAR(errors.greatest, 0.5, 1e-15);
  EXPECT_EQ(errors.mae_surface, 0);
}

TEST(CollisionErrors, SpinsCountAsSpeedOfTheSurface) {
  const auto errors = errors_of(Offset({0, 0, 0}, {0, 0, 0}, {60, 0, 0}), head_on(), 0, 1);
  EXPECT_NEAR(errors.mae_surface, 60 * 1e-3 / 6, 1e-15);
  EXPECT_EQ(errors.mae_velocity, 0);
  EXPECT_NEAR(errors.energy_gain, 0.2 * 0.06 * 0.06 / 5, 1e-15) << "1/2 (2/5) (r w)^2 of 5 m^2/s^2";
}

TEST(CollisionErrors, RelativeErrorsAreOfEachSphere) {
  // 0.3 of 3 m/s, 0.4 of 1 m/s
  const auto errors = errors_of(Offset({0, 0.3, 0}, {0, 0, 0.4}), head_on(), 0, 1);
  EXPECT_NEAR(errors.relative[1], 0.25, 1e-14);
  EXPECT_NEAR(errors.relative[2], 0.1 + 0.9 * 0.3, 1e-14);

  auto resting = head_on();
  resting.parting.after.velocity_2.setZero();
  const auto model = motion_after(Offset({0, 0.3, 0}, {0, 0, 0}), resting.pairs);
  EXPECT_EQ(relative_errors(model, resting.parting.after).size(), 1u) << "nothing to be relative to";
}

TEST(CollisionErrors, MomentumMadeIsAShareOfWhatThePairCarries) {
  // Masses 1 and 2: made -0.5 + 2 * 0.5 = 0.5 of 3 + 2.
  const auto set = head_on(2000);
  EXPECT_NEAR(errors_of(Offset({-0.5, 0, 0}, {0.5, 0, 0}), set, 0, 1).momentum_error, 0.1, 1e-14);
  EXPECT_NEAR(errors_of(Offset({-1, 0, 0}, {0.5, 0, 0}), set, 0, 1).momentum_error, 0, 1e-15);
}

TEST(CollisionErrors, EnergyOfTheModelAndOfTheSet) {
  auto set = head_on();
  set.parting.after.velocity_2.setZero();                                  // 9 of 10 are left
  const auto loses = errors_of(Offset({-2, 0, 0}, {1, 0, 0}), set, 0, 1);  // 1 of 10
  EXPECT_NEAR(loses.energy_lost, 0.9, 1e-14);
  EXPECT_NEAR(loses.energy_lost_truth, 0.1, 1e-14);
  EXPECT_EQ(loses.energy_gain, 0);
  EXPECT_EQ(loses.gaining_share, 0);
  const auto gains = errors_of(Offset({1, 0, 0}, {0, 0, 0}), set, 0, 1);  // 17 of 10
  EXPECT_NEAR(gains.energy_gain, 0.7, 1e-14);
  EXPECT_EQ(gains.gaining_share, 1);
}

TEST(CollisionErrors, OnlyThePairsAskedForCount) {
  auto set = CollisionSet{};
  set.pairs = Pairs(3);
  set.pairs.diameter_1 = 1e-3, set.pairs.diameter_2 = 1e-3;
  set.pairs.density_1 = 1000, set.pairs.density_2 = 1000;
  set.pairs.before.velocity_1.col(0) << 1, 2, 4;
  set.parting.after = set.pairs.before;
  set.parting.after.velocity_1(0, 0) = 100;
  set.parting.after.velocity_1(2, 0) = 4.5;
  const auto errors = errors_of(Offset({0, 0, 0}, {0, 0, 0}), set, 1, 2);
  EXPECT_EQ(errors.n_pairs, 2u);
  EXPECT_NEAR(errors.mae[0], 0.5 / 4, 1e-15);
  EXPECT_NEAR(errors.relative[3], 0.99 * (0.5 / 4.5), 1e-14);
}

TEST(CollisionErrors, RestingPairsHaveNoShares) {
  auto set = head_on();
  set.pairs.before.velocity_1.setZero();
  set.pairs.before.velocity_2.setZero();
  set.parting.after = set.pairs.before;
  const auto errors = errors_of(Offset({1, 0, 0}, {0, 0, 0}), set, 0, 1);
  EXPECT_EQ(errors.momentum_error, 0);
  EXPECT_EQ(errors.energy_gain, 0);
  EXPECT_EQ(errors.relative[0], 0);
}

TEST(CollisionErrors, TheJsonHoldsThem) {
  const auto errors = errors_of(Offset({0.1, -0.2, 0}, {0.3, 0.4, -0.5}), head_on(), 0, 1);
  const auto json = nlohmann::json::parse(to_json(errors));
  EXPECT_EQ(json.at("n_pairs"), 1);
  EXPECT_EQ(json.at("mae_m_per_s").at(1).get<double>(), errors.mae[1]);
  EXPECT_EQ(json.at("energy_gain").get<double>(), errors.energy_gain);
}

}  // namespace
}  // namespace elrom::particle
