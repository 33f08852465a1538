#include "elrom/surrogate/learn.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"

namespace elrom::surrogate {
namespace {

using particle::CollisionSet;
using particle::SurrogateKind;

CollisionSet set_of(const particle::Protocol& protocol, const particle::ContactLaw& law,
                    std::size_t n = 8000) {
  return make_collisions(protocol, law, 1, 0, n, {});
}

const particle::Protocol spinning{.diameter_2 = {475e-6, 475e-6}, .spin_speed = 5};
const particle::ContactLaw hertz{.kind = particle::LawKind::hertz, .friction = 0.3};
const particle::ContactLaw linear{.friction = 0.3, .stiffness = 1e6};

// What the issue of collisions asks for, from an eighth of the pairs.
TEST(LearnCollisions, FrameIsWithinFiveMillimetresASecond) {
  for (const auto& law : {hertz, linear})
    for (const auto& protocol : {spinning, particle::Protocol{}}) {
      const auto learned = learn_collisions(set_of(protocol, law), nullptr, {}, {});
      EXPECT_LT(learned.errors.mae_velocity, 0.005) << law.text();
      EXPECT_LT(learned.errors.momentum_error, 1e-13);
      EXPECT_LT(learned.errors.energy_gain, 1e-12);
    }
}

// A model learned from one pair of sizes serves others, since two dimensionless numbers carry them.
TEST(LearnCollisions, FrameServesSizesThatItNeverSaw) {
  const auto learned = learn_collisions(set_of(spinning, hertz), nullptr, {}, {});
  const particle::Protocol others{.speed = {0, 15},
                                  .diameter_1 = {200e-6, 1e-3},
                                  .diameter_2 = {200e-6, 1e-3},
                                  .density_1 = 1000,
                                  .density_2 = 1000,
                                  .spin_speed = 4};
  const auto set = set_of(others, hertz, 2000);
  EXPECT_LT(errors_of(*learned.bundle.model, set, 0, set.size()).mae_velocity, 0.005);
}

TEST(LearnCollisions, NothingIsLearnedFromThePairsThatJudge) {
  auto set = set_of(spinning, linear, 4000);
  const auto model = learn_collisions(set, nullptr, {}, {}).bundle.model;
  const auto n_test = static_cast<Eigen::Index>(particle::n_test_pairs(set.size()));
  set.parting.after.velocity_1.bottomRows(n_test) = 99;
  set.parting.after.velocity_2.bottomRows(n_test) = -99;
  const auto again = learn_collisions(set, nullptr, {}, {});
  particle::Impulses a, b;
  model->impulses(set.pairs, a);
  again.bundle.model->impulses(set.pairs, b);
  EXPECT_TRUE((a.linear_1 == b.linear_1).all());
  EXPECT_GT(again.errors.mae_velocity, 50);
}

TEST(LearnCollisions, ExactRestsOnTheLawAlone) {
  const auto learned =
      learn_collisions(set_of({.kind = particle::ProtocolKind::document}, {.stiffness = 1e6}, 200), nullptr,
                       {.surrogate = SurrogateKind::exact}, {});
  EXPECT_LT(learned.errors.greatest, 1e-4);
  EXPECT_EQ(learned.bundle.provenance.at("surrogate"), "exact");
  EXPECT_EQ(learned.bundle.provenance.at("pairs"), "200");
}

// Capped or overlapped pairs belong to no impact angle.
TEST(LearnCollisions, FrameRefusesWhatDidNotBeginAtTouching) {
  const particle::Protocol overlapped{.kind = particle::ProtocolKind::document, .approach_time = 1e-4};
  EXPECT_THROW((void)learn_collisions(set_of(overlapped, {.stiffness = 1e6}, 200), nullptr, {}, {}),
               UsageError);
  const auto capped = make_collisions({}, linear, 1, 0, 200, {}, 5.0);
  EXPECT_THROW((void)learn_collisions(capped, nullptr, {}, {}), UsageError);
}

TEST(LearnCollisions, SaysWhatThisBuildLacks) {
  const auto set = set_of(spinning, linear, 400);
  EXPECT_THROW((void)learn_collisions(set, nullptr, {.regressor = RegressorKind::network}, {}),
               NotBuiltError);
  EXPECT_THROW((void)learn_collisions(set, nullptr, {.regressor = RegressorKind::trees}, {}), NotBuiltError);
  EXPECT_THROW((void)learn_collisions(set, nullptr, {.surrogate = SurrogateKind::document}, {}),
               NotBuiltError);
}

}  // namespace
}  // namespace elrom::surrogate
