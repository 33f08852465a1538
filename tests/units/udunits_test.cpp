#include "elrom/units/udunits.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <thread>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::units {
namespace {

/// "90 deg" in SI, with the SI unit's spelling.
std::pair<double, std::string> si(double value, std::string_view symbol) {
  const auto unit = find(symbol);
  if (!unit) return {std::nan(""), "unknown"};
  EXPECT_EQ(unit->symbol, symbol);
  return {unit->to_si(value), unit->si};
}

void expect_si(double value, std::string_view symbol, double expected, const std::string& expected_unit) {
  const auto [found, unit] = si(value, symbol);
  EXPECT_NEAR(found, expected, 1e-12 * std::abs(expected)) << symbol;
  EXPECT_EQ(unit, expected_unit) << symbol;
}

TEST(Udunits, UnitsOfTheFieldAreReadToSi) {
  expect_si(250, "kW/m2", 250e3, "W/m2");
  expect_si(5, "W/m2", 5, "W/m2");
  expect_si(400, "ppm", 400e-6, "1");
  expect_si(90, "deg", std::acos(-1) / 2, "rad");
  expect_si(12, "MJ/kg", 12e6, "J/kg");
  expect_si(2, "kJ/(kg K)", 2e3, "J/(kg K)");
  expect_si(3, "1/min", 0.05, "1/s");
  expect_si(60, "rpm", 2 * std::acos(-1), "rad/s");
  expect_si(7.2, "m3/h", 0.002, "m3/s");
  expect_si(1, "psi", 6894.757293168361, "Pa");
  expect_si(2, "kWh", 7.2e6, "J");
}

TEST(Udunits, TheSameUnitsAsInTheTableHaveTheSameSi) {
  for (const auto* symbol :
       {"%", "t/h", "g", "um", "degC", "mbar", "km/h", "min", "g/cm3", "kN/m", "rad/s", "MW"}) {
    const auto& known = base::unit(symbol);
    expect_si(10, symbol, known.to_si(10), known.si);
  }
}

TEST(Udunits, TemperaturesKeepTheirOffset) {
  const auto unit = find("degF");
  ASSERT_TRUE(unit);
  EXPECT_EQ(unit->si, "K");
  EXPECT_NEAR(unit->to_si(212), 373.15, 1e-10);
  EXPECT_NEAR(unit->from_si(273.15), 32, 1e-10);
}

TEST(Udunits, NormalCubicMetresAreAQuantityOfTheirOwn) {
  expect_si(3600, "Nm3/h", 1, "Nm3/s");
  expect_si(3600, "Nm\u00b3/h", 1, "Nm3/s");
  expect_si(250, "mg/Nm3", 250e-6, "kg/Nm3");
  EXPECT_NE(si(1, "Nm3/h").second, si(1, "m3/h").second);
  expect_si(1, "Nm", 1, "J");  // a torque
}

TEST(Udunits, SpellingsOfTheFieldAreRead) {
  for (const auto* symbol : {"W/m2K", "W/(m2 K)", "W/(m2.K)", "W/m2/K", "W m-2 K-1", "W/m\u00b2K",
                             "W\u00b7m\u207b\u00b2\u00b7K\u207b\u00b9"})
    expect_si(2, symbol, 2, "W/(m2 K)");
  for (const auto* symbol : {"kg/m2s", "kg/(m2 s)", "kg/m2/s", "kg m-2 s-1", "kg/m^2s"})
    expect_si(2, symbol, 2, "kg/(m2 s)");
  expect_si(2, "kJ/kgK", 2e3, "J/(kg K)");
  expect_si(2, "mPas", 2e-3, "Pa s");
}

TEST(Udunits, WhatCanBeReadInTwoWaysIsRefusedWithBoth) {
  EXPECT_ERROR(InputError, "unit 'W/m2 K' can be read in two ways: expected W/(m2 K), or W K/m2",
               find("W/m2 K"));
  EXPECT_ERROR(InputError, "expected kg/(m2 s), or kg s/m2", find("kg/m2.s"));
}

TEST(Udunits, WhatIsNoMultipleOrUnknownIsNotFound) {
  for (const auto* symbol : {"furlongs_of_nothing", "barg", "lg(re 1 mW)", "kg/", "(kg", "Nm4", "", "  "})
    EXPECT_FALSE(find(symbol)) << symbol;
}

TEST(Udunits, ADimensionWithoutANameIsReadAgainAsItIsWritten) {
  const auto unit = find("g.m4");
  ASSERT_TRUE(unit);
  expect_si(1, unit->si, 1, unit->si);
  const auto normal = find("1/Nm3");
  ASSERT_TRUE(normal);
  expect_si(1, normal->si, 1, normal->si);
}

TEST(Udunits, TheTableOfUnitsAsksItWhenToldTo) {
  use_udunits();
  EXPECT_EQ(base::unit("kW/m2").si, "W/m2");
  EXPECT_EQ(&base::unit("kW/m2"), &base::unit("kW/m2"));
  EXPECT_DOUBLE_EQ(base::quantity("45deg", "rad"), std::acos(-1) / 4);
  EXPECT_ERROR(InputError, "of another dimension", base::quantity("3 W/m2", "Pa"));
  base::set_unit_source({});
}

TEST(Udunits, ThreadsMayAskAtOnce) {
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([i] {
      for (int k = 1; k < 200; ++k) expect_si(1, std::to_string(k + i) + " W/m2", k + i, "W/m2");
    });
}

}  // namespace
}  // namespace elrom::units
