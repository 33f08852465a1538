// Residence times against times that are known: spheres that fly straight to an outlet.
#include "elrom/scene/residence.hpp"

#include "elrom/scene/simulation.hpp"
#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

TEST(ResidenceTimes, QuantilesAreThoseOfTheTimesToHalfABin) {
  ResidenceTimes times;
  EXPECT_TRUE(std::isnan(times.mean()));
  EXPECT_TRUE(std::isnan(times.quantile(0.5)));
  for (int k = 1; k <= 1000; ++k) times.add(0.01 * k);
  EXPECT_EQ(times.number(), 1000);
  EXPECT_NEAR(times.mean(), 5.005, 1e-12);
  for (const double share : {0.1, 0.5, 0.9})
    EXPECT_NEAR(times.quantile(share), 10 * share, 0.06 * 10 * share);
}

TEST(ResidenceTimes, WhatLiesBeyondTheBinsIsInTheOuterOnes) {
  ResidenceTimes times;
  for (const double seconds : {0.0, 1e-9, 1e9}) times.add(seconds);
  EXPECT_EQ(times.counts.front(), 2);
  EXPECT_EQ(times.counts.back(), 1);
}

// Two groups 0.1 m from the outlet at 1 and 2 m/s; walls aside are met by nobody.
TEST(ResidenceTimes, SpheresOfEachGroupLeaveAfterTheirFlight) {
  const auto group = [](const std::string& name, const std::string& speed, const std::string& over) {
    return "[[particles]]\ngroup = \"" + name +
           "\"\ndiameter = \"100 um\"\nnumber = 50\nregion = \"start\"\nvelocity = [" + speed +
           ", 0, 0]\nover = " + over + "\n";
  };
  const std::string text =
      "[scene]\nduration = 0.3\ntime_step = 1e-4\n[domain]\noutlets = [\"box.x_high\"]\n"
      "[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.1, 0.01, 0.01]\n"
      "[[regions]]\nname = \"start\"\nlow = [0, 0, 0]\nhigh = [0.001, 0.01, 0.01]\n";
  // The fast ones come one after another: each counts from its own beginning.
  Simulation simulation(parse_scene(text + group("slow", "1", "0") + group("fast", "2", "0.1"), "r.toml"), 1);
  while (!simulation.done()) simulation.step();
  const auto& residence = simulation.state().tally.residence;
  EXPECT_EQ(residence[0].number(), 50);
  EXPECT_EQ(residence[1].number(), 50);
  EXPECT_NEAR(residence[0].mean(), 0.0995, 6e-4);
  EXPECT_NEAR(residence[1].mean(), 0.0498, 4e-4);
}

}  // namespace
}  // namespace elrom::scene
