#include "elrom/io/settings_table.hpp"

#include <gmock/gmock.h>

#include "support/throws.hpp"

namespace elrom::io {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::ThrowsMessage;

struct Valve {
  std::string name;
  double bore = 1;
};

struct Pump {
  std::string drive = "belt";
  std::int64_t serial = 0;
  double rate = 1;
  bool cooled = false;
  int stages = 1;
  char side = 'a';
  std::vector<double> curve{1, 2};
  std::optional<std::vector<std::string>> spares;
  std::vector<std::pair<std::string, std::string>> joints;
  std::map<std::string, std::string> finish;
  std::vector<Valve> valves;
};

SettingsTable<Valve> valve_table() {
  SettingsTable<Valve> t;
  t.word(
       "name", "of the valve", [](auto& v) -> auto& { return v.name; })
      .require();
  t.real(
      "bore", "inner diameter", [](auto& v) -> auto& { return v.bore; }, 0, 10);
  return t;
}

SettingsTable<Pump> pump_table() {
  SettingsTable<Pump> t;
  t.word("drive", "what turns it", [](auto& p) -> auto& { return p.drive; }, {"belt", "shaft"});
  t.whole(
      "serial", "number", [](auto& p) -> auto& { return p.serial; }, INT64_MIN, INT64_MAX);
  t.real(
      "flow.rate", "what it delivers", [](auto& p) -> auto& { return p.rate; }, 0, 100);
  t.flag(
      "flow.cooled", "with a jacket", [](auto& p) -> auto& { return p.cooled; });
  t.range(
      "flow.curve", "range", [](auto& p) -> auto& { return p.curve; }, 0, 50);
  t.whole(
      "build.stages", "wheels", [](auto& p) -> auto& { return p.stages; }, 1, 9);
  t.word("build.side", "of the inlet", [](auto& p) -> auto& { return p.side; }, {"a", "b"});
  t.words(
      "build.spares", "in the box", [](auto& p) -> auto& { return p.spares; });
  t.pairs(
      "build.joints", "what is bolted to what", [](auto& p) -> auto& { return p.joints; });
  t.choices_by_name("build.finish", "of parts", [](auto& p) -> auto& { return p.finish; }, {"raw", "ground"});
  t.tables(
      "build.valve", "on its outlet", [](auto& p) -> auto& { return p.valves; }, valve_table(),
      [](const Valve& valve) { return valve.bore > 0 ? std::string() : std::string("a bore"); });
  return t;
}

Pump read(const std::string& text) {
  Pump pump;
  pump_table().read(pump, parse_settings(text, "pump.toml"));
  return pump;
}

void expect_refused(const std::string& text, const std::string& a, const std::string& b) {
  EXPECT_THAT([&] { (void)read(text); }, ThrowsMessage<UsageError>(AllOf(HasSubstr(a), HasSubstr(b))))
      << text;
}

const std::string whole_file =
    "drive = \"shaft\"\nserial = -9223372036854775808\nflow.rate = 3\nflow.cooled = true\nflow.curve = [2, 7.5]\n"
    "[build]\nstages = 4\nside = \"b\"\nspares = [\"seal\"]\njoints = [[\"a\", \"b\"]]\nfinish = {\"a.b\" = \"raw\"}\n"
    "[[build.valve]]\nname = \"v\"\n[[build.valve]]\nname = \"w\"\nbore = 2\n";

TEST(SettingsTable, ReadsEveryKindOfRow) {
  const auto pump = read(whole_file);

  EXPECT_EQ(pump.drive, "shaft");
  EXPECT_EQ(pump.serial, INT64_MIN);
  EXPECT_EQ(pump.rate, 3);
  EXPECT_TRUE(pump.cooled);
  EXPECT_THAT(pump.curve, ElementsAre(2, 7.5));
  EXPECT_EQ(pump.stages, 4);
  EXPECT_EQ(pump.side, 'b');
  EXPECT_THAT(pump.spares.value(), ElementsAre("seal"));
  EXPECT_THAT(pump.joints, ElementsAre(Pair("a", "b")));
  EXPECT_THAT(pump.finish, ElementsAre(Pair("a.b", "raw")));
  ASSERT_EQ(pump.valves.size(), 2U);
  EXPECT_EQ(pump.valves[0].bore, 1);
  EXPECT_EQ(pump.valves[1].name, "w");
}

TEST(SettingsTable, WrittenTextReadsBackToItself) {
  auto pump = read(whole_file);
  pump.spares = {{"tab\there", "quote\"", "back\\slash", "line\nbreak", "\x7f"}};
  const auto text = pump_table().write(pump);

  const auto again = read(text);

  EXPECT_EQ(pump_table().write(again), text);
  EXPECT_EQ(again.spares, pump.spares);
  EXPECT_EQ(again.valves.size(), 2U);
}

TEST(SettingsTable, WhatIsNotSetIsNotWritten) {
  const Pump pump;
  EXPECT_EQ(pump_table().write(pump, "flow"), "\n[flow]\nrate = 1.0\ncooled = false\ncurve = [1.0, 2.0]\n");
  EXPECT_THAT(pump_table().write(pump), ::testing::Not(HasSubstr("spares")));
}

TEST(SettingsTable, AMistakenKeyIsRefusedWithPlaceAndNearestName) {
  expect_refused("serial = 1\n[flow]\nrata = 2\n", "'flow.rata' in pump.toml:3", "did you mean 'flow.rate'?");
  expect_refused("stages = 2\n", "pump.toml:1", "did you mean 'build.stages'?");
  expect_refused("[flow]\nqqqqqqqq = 2\n", "pump.toml:2",
                 "known there are: flow.rate, flow.cooled, flow.curve");
  expect_refused("[build]\n[[build.valve]]\nnam = \"v\"\n", "'build.valve.nam' in pump.toml:3",
                 "did you mean 'name'?");
  expect_refused("[flw]\nrate = 2\n", "'flw' in pump.toml:1", "did you mean 'flow'?");
}

TEST(SettingsTable, AValueOfAnotherTypeOrRangeIsRefusedWithWhatWasExpected) {
  expect_refused("drive = \"belts\"\n", "found \"belts\", expected one of belt, shaft", "pump.toml:1");
  expect_refused("drive = 3\n", "found 3", "a text in quotes");
  expect_refused("serial = 1.5\n", "found 1.5", "expected a whole number");
  expect_refused("flow.rate = 101\n", "setting flow.rate", "a number from 0 to 100");
  expect_refused("flow.rate = nan\n", "found nan", "a number from 0 to 100");
  expect_refused("flow.rate = true\n", "found true", "a number");
  expect_refused("flow.cooled = 1\n", "found 1", "true or false");
  expect_refused("flow.curve = [7, 2]\n", "found [7, 2]", "[smallest, largest]");
  expect_refused("flow.curve = [2]\n", "found [2]", "[smallest, largest]");
  expect_refused("flow.curve = [2, \"x\"]\n", "found [2, \"x\"]", "[smallest, largest]");
  expect_refused("build.stages = 0\n", "found 0", "a whole number from 1 to 9");
  expect_refused("build.side = \"ab\"\n", "found \"ab\"", "one of a, b");
  expect_refused("build.spares = [1]\n", "found [1]", "a list of texts");
  expect_refused("build.joints = [[\"a\"]]\n", "found [[\"a\"]]", "a list of pairs");
  expect_refused("build.finish = {a = \"shiny\"}\n", "setting build.finish.a", "one of raw, ground");
  expect_refused("build.finish = 3\n", "found 3", "a table of name = \"raw\" | \"ground\"");
  expect_refused("flow.rate = 2020-01-01\n", "found a date", "a number");
  expect_refused("flow = 3\n", "unknown setting 'flow'", "pump.toml:1");
}

TEST(SettingsTable, ListsOfTablesAreCheckedOneByOne) {
  expect_refused("[build]\nvalve = 3\n", "found 3", "[[build.valve]] tables");
  expect_refused("[[build.valve]]\nbore = 2\n", "missing setting 'build.valve.name'", "pump.toml:1");
  expect_refused("[[build.valve]]\nname = \"v\"\n[[build.valve]]\nname = \"w\"\nbore = 0\n", "pump.toml:3",
                 "expected a bore");
}

TEST(SettingsTable, AFileCanBeAnInputToo) {
  Pump pump;
  EXPECT_ERROR(InputError, "did you mean 'drive'?",
               pump_table().read(pump, parse_settings("drve = 1", "p", SettingsFault::input)));
  EXPECT_ERROR(InputError, "p:2", parse_settings("a = 1\na = 2", "p", SettingsFault::input));
}

TEST(SettingsTable, ALaterFileChangesOnlyWhatItNames) {
  auto pump = read(whole_file);

  pump_table().read(pump, parse_override("build.stages = 7"));

  EXPECT_EQ(pump.stages, 7);
  EXPECT_EQ(pump.rate, 3);
}

TEST(Override, TakesABareWordForAText) {
  EXPECT_EQ(*parse_override("drive=shaft").member("drive")->text(), "shaft");
  EXPECT_EQ(*parse_override(R"(drive = a "b" \c)").member("drive")->text(), R"(a "b" \c)");
  EXPECT_EQ(*parse_override("n=3").member("n")->whole(), 3);
  EXPECT_ERROR(UsageError, "setting n in --set n=x: found \"x\"",
               read_whole(*parse_override("n=x").member("n"), 0, 9));
  EXPECT_ERROR(UsageError, "expected key=value", parse_override("drive"));
  EXPECT_ERROR(UsageError, "expected key=value", parse_override("=3"));
}

TEST(SettingsTable, RowsThatTomlCannotWriteAreOurMistake) {
  const auto rate = [](auto& p) -> auto& { return p.rate; };
  SettingsTable<Pump> twice;
  twice.real("a.x", "", rate, 0, 1);
  EXPECT_THROW(twice.real("a.x", "", rate, 0, 1), std::logic_error);
  SettingsTable<Pump> apart;
  apart.real("a.x", "", rate, 0, 1);
  apart.real("b.x", "", rate, 0, 1);
  EXPECT_THROW(apart.real("a.y", "", rate, 0, 1), std::logic_error);
  EXPECT_THROW(apart.real("y", "", rate, 0, 1), std::logic_error);
}

struct Jet {
  struct Direction {
    double x = 0, y = 0, z = 0;
  };
  double width = 0;
  Direction velocity;
};

SettingsTable<Jet> jet_table() {
  SettingsTable<Jet> table;
  table.quantity(
      "width", "", [](auto& j) -> auto& { return j.width; }, "m", 0, 1);
  table.vector(
      "velocity", "", [](auto& j) -> auto& { return j.velocity; }, "m/s");
  return table;
}

TEST(SettingsTable, QuantitiesTakeUnitsAndAreWrittenInSi) {
  Jet jet;
  jet_table().read(jet, parse_settings("width = \"15 mm\"\nvelocity = [1, \"36 km/h\", 0]", "jet.toml"));
  EXPECT_DOUBLE_EQ(jet.width, 0.015);
  EXPECT_DOUBLE_EQ(jet.velocity.y, 10);
  Jet again;
  jet_table().read(again, parse_settings(jet_table().write(jet), "again.toml"));
  EXPECT_EQ(again.width, jet.width);
  EXPECT_EQ(again.velocity.y, jet.velocity.y);
}

TEST(SettingsTable, QuantitiesOfAnotherDimensionOrRangeAreRefused) {
  Jet jet;
  for (const auto* text : {"width = \"3 kg\"", "width = \"2 m\"", "width = -1", "width = nan", "width = true",
                           "velocity = [1, 2]", "velocity = 3", "velocity = [1, 2, inf]"})
    EXPECT_THROW(jet_table().read(jet, parse_settings(text, "jet.toml")), UsageError) << text;
}

}  // namespace
}  // namespace elrom::io
