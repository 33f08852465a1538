#include "elrom/particle/contact_law.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/particle/pairs.hpp"
#include "particle/pairs_for_tests.hpp"

namespace elrom::particle {
namespace {

using test::expect_refused;

constexpr Ball glass{20e-3, 2800}, limestone{20e-3, 2500};
constexpr ContactLaw glass_law{
    .kind = LawKind::hertz, .restitution = 1, .youngs_modulus = 48e9, .poisson_ratio = 0.2};
constexpr ContactLaw limestone_law{
    .kind = LawKind::hertz, .restitution = 1, .youngs_modulus = 20e9, .poisson_ratio = 0.25};

// Chung & Ooi 2011, test 1: spheres of 10 mm radius meet at 10 m/s each.
TEST(ContactLaw, GivesThePublishedHertzContactOfGlass) {
  const PairContact contact(glass_law, glass, glass);
  const double overlap = contact.greatest_overlap(20);
  EXPECT_NEAR(overlap, 274.1e-6, 0.05e-6);
  EXPECT_NEAR(contact.stiffness * std::pow(overlap, 1.5), 10.697e3, 0.5);
  EXPECT_NEAR(contact.duration(20), 40.34e-6, 0.005e-6);
}

TEST(ContactLaw, GivesThePublishedHertzContactOfLimestone) {
  const PairContact contact(limestone_law, limestone, limestone);
  const double overlap = contact.greatest_overlap(20);
  EXPECT_NEAR(overlap, 368.3e-6, 0.05e-6);
  EXPECT_NEAR(contact.stiffness * std::pow(overlap, 1.5), 7.108e3, 0.5);
  EXPECT_NEAR(contact.duration(20), 54.20e-6, 0.01e-6);
}

// The rule's rounded 2.87 against the exact 2.868: 12.235 us against 12.228).
TEST(StepTimes, HertzIsTheContactsDurationButForItsRoundedConstant) {
  const auto times = step_times(glass_law, 20, glass, glass);
  EXPECT_NEAR(times.hertz / PairContact(glass_law, glass, glass).duration(20), 12.235 / 12.228, 2e-4);
}

// By hand: r 10 mm, G 20 GPa, nu 0.2: pi 0.01 sqrt(2800 / 2e10) / 0.90922.
TEST(StepTimes, RayleighIsTheHandValue) {
  EXPECT_NEAR(step_times(glass_law, 20, glass, glass).rayleigh, 12.9284e-6, 1e-10);
}

TEST(StepTimes, RayleighIsOfTheSmallerSphere) {
  const auto both = step_times(glass_law, 20, glass, {2e-3, 2800});
  EXPECT_DOUBLE_EQ(both.rayleigh, step_times(glass_law, 20, {2e-3, 2800}, {2e-3, 2800}).rayleigh);
}

TEST(StepTimes, StepIsAFifthOfTheShortest) {
  EXPECT_DOUBLE_EQ((StepTimes{3, 2, 5, 1000}).step(), 0.4);
  EXPECT_DOUBLE_EQ((StepTimes{1, 2, 5, 1000}).step(), 0.2);
  EXPECT_DOUBLE_EQ((StepTimes{3, 2, 1, 1000}).step(), 0.2);
}

TEST(StepTimes, LinearStepIsATwentiethOfTheContact) {
  const ContactLaw law{.restitution = 0.9, .stiffness = 1000};
  const Ball ball{315e-6, 1000};
  const double m12 = sphere_mass(315e-6, 1000) / 2;
  const double tau = std::sqrt(m12 / 1000) * std::hypot(std::numbers::pi, std::log(0.9));
  const auto times = step_times(law, 1, ball, ball);
  EXPECT_NEAR(times.step() / (tau / 20), 1, 1e-12);
  EXPECT_NEAR(times.cundall / (2 * std::sqrt(m12 / 1000)), 1, 1e-12);
}

// gamma = -2 m12 ln e / tau.
TEST(ContactLaw, LinearDampingIsTheClosedForm) {
  const ContactLaw law{.restitution = 0.8, .stiffness = 500};
  const PairContact contact(law, {315e-6, 1000}, {475e-6, 1200});
  const double m1 = sphere_mass(315e-6, 1000), m2 = sphere_mass(475e-6, 1200), m12 = m1 * m2 / (m1 + m2);
  const double tau = std::sqrt(m12 / 500) * std::hypot(std::numbers::pi, std::log(0.8));
  EXPECT_NEAR(contact.reduced_mass / m12, 1, 1e-14);
  EXPECT_NEAR(contact.damping / (-2 * m12 * std::log(0.8) / tau), 1, 1e-14);
  EXPECT_NEAR(contact.tangential_stiffness / 500, 2.0 / 7, 1e-14);
}

TEST(ContactLaw, StiffnessForAnOverlapGivesThatOverlap) {
  const Ball one{315e-6, 1000}, two{475e-6, 1000};
  const ContactLaw law{.restitution = 1, .stiffness = stiffness_for_overlap(0.01, 40, one, two)};
  EXPECT_NEAR(PairContact(law, one, two).greatest_overlap(40) / 3.15e-6, 1, 1e-12);
}

TEST(ContactLaw, RefusesWhatNoMaterialHas) {
  expect_refused([] { ContactLaw{.restitution = -0.1, .stiffness = 1}.check(); }, "restitution: found -0.1");
  expect_refused([] { ContactLaw{.restitution = 1.1, .stiffness = 1}.check(); }, "restitution");
  expect_refused([] { ContactLaw{.restitution = NAN, .stiffness = 1}.check(); }, "restitution");
  expect_refused([] { ContactLaw{.friction = -1, .stiffness = 1}.check(); }, "friction");
  expect_refused([] { ContactLaw{.tangential_restitution = 2, .stiffness = 1}.check(); }, "tangential");
  expect_refused([] { ContactLaw{.stiffness = 0}.check(); }, "stiffness");
  expect_refused([] { ContactLaw{.kind = LawKind::hertz, .youngs_modulus = 0}.check(); }, "Young");
  expect_refused([] { ContactLaw{.kind = LawKind::hertz, .poisson_ratio = 0.7}.check(); }, "Poisson");
}

TEST(ContactLaw, SaysItselfInWords) {
  EXPECT_EQ((ContactLaw{.friction = 0.3, .stiffness = 1.2e6}).text(), "linear, e 0.9, mu 0.3, 1.2e+06 N/m");
  EXPECT_EQ((ContactLaw{.kind = LawKind::hertz, .restitution = 1}).text(),
            "hertz, e 1, mu 0, E 1e+09 Pa, nu 0.3");
}

}  // namespace
}  // namespace elrom::particle
