#include "elrom/report/scenes.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::report {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A run of two spheres of group a and two of b, and a section of two cells, as elrom-simulate leaves it.
struct FakeRun {
  std::string model = "dem", scene = "two";
  double step = 1e-4, end = 1, seconds = 10, collisions = 100, resumed_from = 0;
  std::array<double, 2> fraction{0.1, 0.3}, velocity{1, 2};
  std::array<float, 12> places{0, 0, 0, 2, 0, 0, 0, 5, 0, 2, 5, 0};  // of two spheres each
  bool has_section = true, has_row = false;
  std::string gas = "none";
};

std::string summary_of(const FakeRun& run) {
  auto json = io::json_head<nlohmann::ordered_json>(io::kinds::scene_summary);
  json.update({{"scene", run.scene},
               {"collision_model", run.model},
               {"time_step_s", run.step},
               {"time_s", run.end},
               {"threads", 1},
               {"spheres", 2},
               {"wall_hits", 3},
               {"resumed_from", run.resumed_from},
               {"collisions", run.collisions}});
  json["effects"] = {{{"name", "a"}, {"seconds", 0.25 * run.seconds}},
                     {{"name", "b"}, {"seconds", 0.75 * run.seconds}}};
  return json.dump();
}

// Before half of the time the cells hold something else, which must not count.
std::string section_of(const FakeRun& run) {
  std::string text =
      "time [s],x [m],y [m],z [m],number,mass [kg],volume_fraction,velocity_x [m/s],velocity_y [m/s],velocity_z [m/s]\n";
  for (const double time : {0.0, 0.75 * run.end, run.end})
    for (std::size_t k = 0; k < 2; ++k)
      text += fmt::format("{},0,0,{},1,1,{},0,0,{}\n", time, k, time == 0 ? 0.9 : run.fraction[k],
                          run.velocity[k]);
  return text;
}

std::string picture_of(const FakeRun& run) {
  const std::array<std::int32_t, 4> groups{0, 0, 1, 1};
  std::string data;
  const auto append = [&](const void* from, std::uint64_t size) {
    data.append(reinterpret_cast<const char*>(&size), sizeof size);
    data.append(static_cast<const char*>(from), size);
  };
  append(run.places.data(), sizeof run.places);
  const auto offset = data.size();
  append(groups.data(), sizeof groups);
  return fmt::format(
      "<Piece NumberOfPoints=\"4\"><DataArray Name=\"Points\" offset=\"0\"/><DataArray Name=\"group\" "
      "offset=\"{}\"/>\n<AppendedData encoding=\"raw\">\n_{}\n</AppendedData>",
      offset, data);
}

// Solids that fall in the outermost two of four cells.
std::string row_across() {
  std::string text =
      "time [s],x [m],y [m],z [m],number,mass [kg],volume_fraction,velocity_x [m/s],velocity_y [m/s],velocity_z "
      "[m/s],gas_pressure [Pa]\n";
  for (const double time : {0.5, 1.0})
    for (int k = 0; k < 4; ++k)
      text += fmt::format("{},{},0,0.5,1,1,{},0,0,{},{}\n", time, k, k == 0 ? 0.3 : 0.1,
                          k % 3 == 0 ? -0.2 : 0.4, 100 * time + k);
  return text;
}

class Scenes : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const FakeRun& run) const {
    std::filesystem::create_directories(folder / name);
    const auto put = [&](const char* file, const std::string& text) {
      folder.write(name + "/" + file, text);
    };
    put("summary.json", summary_of(run));
    put("series.csv",
        fmt::format("time [s],spheres,kinetic_energy [J],collisions,wall_hits,number of a,mean height of a "
                    "[m],number of b,mean height of b [m],collisions of a and a\n0,2,1,0,0,1,0,1,0,0\n"
                    "{},2,1,{},3,1,0,1,0,1\n",
                    run.end, run.collisions));
    if (run.has_section) put("section_s.csv", section_of(run));
    if (run.has_row) put("section_row.csv", row_across());
    put("scene.toml",
        fmt::format("[scene]\nname = \"two\"\ntime_step = {}\n[gas]\nmodel = \"{}\"\n", run.step, run.gas));
    put("particles.pvd",
        "<DataSet timestep=\"0\" file=\"no.vtp\"/>\n<DataSet timestep=\"1\" file=\"p.vtp\"/>");
    put("p.vtp", picture_of(run));
    return folder / name;
  }
  test::TemporaryFolder folder;
};

TEST_F(Scenes, ErrorIsHalfOfFractionsAndHalfOfFluxesAgainstDemByTheShortestStep) {
  const auto made =
      scene_report({.folders = {write("coarse", {.step = 1e-3}), write("fine", {}),
                                write("m", {.model = "helscm", .collisions = 90, .fraction = {0.2, 0.3}})}});
  EXPECT_EQ(made.reference, 1u);
  EXPECT_TRUE(made.has_yardstick);
  EXPECT_EQ(made.from, 0.5);
  EXPECT_EQ(made.runs[0].error, 0.0);
  EXPECT_FALSE(made.runs[1].error);
  const double of_fraction = std::sqrt(0.01 / 0.1), of_flux = std::sqrt(0.01 / 0.37);
  EXPECT_NEAR(made.runs[2].error.value(), 0.5 * (of_fraction + of_flux), 1e-12);
  EXPECT_NEAR(made.runs[2].collision_error.value(), -0.1, 1e-12);
  EXPECT_THAT(headline(made), HasSubstr("Nearest to DEM on \"two\" is helscm, 100 us"));
  EXPECT_THAT(headline(made), HasSubstr("10.0 % fewer"));
}

TEST_F(Scenes, RowsAcrossTellWhereSolidsFallAndSectionsTheGasPressure) {
  const auto made = scene_report({.folders = {write("d", {.has_row = true})}});
  EXPECT_THAT(terminal_table(made), HasSubstr("ends    middle\n"));
  EXPECT_THAT(terminal_table(made), testing::ContainsRegex("dem, 100 us +row +-0\\.200 +0\\.400\n"));
  const auto sections = nlohmann::json::parse(to_json(made)).at("runs")[0].at("sections");
  ASSERT_EQ(sections.size(), 2u);
  EXPECT_EQ(sections[0].at("pressure_pa"), (std::vector<double>{75, 76, 77, 78}));
  EXPECT_FALSE(sections[1].contains("pressure_pa"));
  EXPECT_THAT(html_page(made), HasSubstr("Pressure of the gas"));
  EXPECT_THAT(terminal_table(scene_report({.folders = {write("o", {})}})), Not(HasSubstr("they fall")));
}

TEST_F(Scenes, FrontIsWhatNoOtherBeatsInErrorAndTime) {
  const auto made = scene_report(
      {.folders = {write("d", {}), write("near", {.model = "helscm", .seconds = 5, .fraction = {0.11, 0.3}}),
                   write("fast", {.model = "none", .seconds = 1, .fraction = {0.2, 0.3}}),
                   write("bad", {.model = "hel", .seconds = 2, .fraction = {0.3, 0.3}})}});
  EXPECT_TRUE(made.runs[1].front);
  EXPECT_TRUE(made.runs[2].front);
  EXPECT_FALSE(made.runs[3].front);
  EXPECT_THAT(cost_sentence(made), HasSubstr("Beaten in both error and time: hel, 100 us"));
  EXPECT_THAT(cost_sentence(made), HasSubstr("by none, 100 us"));
  EXPECT_THAT(terminal_table(made), HasSubstr("not counted"));
}

TEST_F(Scenes, WithoutSectionsGroupsCentresAreComparedByTheirSpread) {
  const FakeRun dem{.has_section = false};
  FakeRun moved{.model = "helscm", .has_section = false};
  for (const std::size_t y : {1u, 4u}) moved.places[y] = 1;  // group a by 1 m; each group spreads by 1 m
  const auto made = scene_report({.folders = {write("d", dem), write("m", moved)}});
  EXPECT_NEAR(made.runs[1].error.value(), std::sqrt(0.5), 1e-6);
  EXPECT_THAT(error_meaning(made), HasSubstr("group's centre"));
}

TEST_F(Scenes, WithoutDemItIsSaidThatNothingIsRight) {
  const auto made =
      scene_report({.folders = {write("a", {.model = "helscm"}), write("b", {.model = "none"})}});
  EXPECT_FALSE(made.has_yardstick);
  EXPECT_THAT(headline(made), HasSubstr("No run of \"two\" is by DEM"));
  EXPECT_THAT(html_page(made), HasSubstr("none (no run by dem)"));
  EXPECT_TRUE(nlohmann::json::parse(to_json(made)).at("yardstick").is_null());
}

TEST_F(Scenes, OtherSettingsTimesAndDurationsAreNamed) {
  const auto made =
      scene_report({.folders = {write("d", {}), write("g", {.model = "helscm", .gas = "uniform"}),
                                write("short", {.model = "none", .end = 0.5}),
                                write("r", {.model = "helscm", .step = 1e-3, .resumed_from = 4})}});
  const auto table = terminal_table(made);
  EXPECT_THAT(table, HasSubstr("differs in gas.model"));
  EXPECT_THAT(table, HasSubstr("not compared"));
  EXPECT_FALSE(made.runs[2].error);
  EXPECT_THAT(table, HasSubstr("in parts"));
  EXPECT_FALSE(made.runs[3].front);
}

TEST_F(Scenes, PageOpensOfflineWithAllItsPartsAndJsonHasItsFigures) {
  const auto made =
      scene_report({.folders = {write("d", {}), write("m", {.model = "helscm", .fraction = {0.2, 0.3}})}});
  const auto page = html_page(made);
  for (const auto* part : {"id=\"runs\"", "id=\"cost\"", "id=\"positions\"", "id=\"profiles\"", "id=\"time\"",
                           "class=\"dots s0\"", "class=\"dots s3\"", "line truth"})
    EXPECT_THAT(page, HasSubstr(part));
  for (const auto* outside : {"src=\"http", "href=\"http", "url("})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
  const auto json = nlohmann::json::parse(to_json(made));
  EXPECT_EQ(json.at("kind"), "elrom-scene-report");
  EXPECT_EQ(json.at("runs").at(1).at("seconds"), 10);
  EXPECT_EQ(json.at("runs").at(1).at("error").get<double>(), made.runs[1].error.value());
  EXPECT_EQ(json.at("runs").at(1).at("sections").at(0).at("volume_fraction").at(0).get<double>(), 0.2);
}

// A row of four cells along x: one place, so one chart a quantity, with a line for each run.
TEST_F(Scenes, ProfilesHaveALineForEachRunAndTheVelocitiesOfTheirDirections) {
  const auto made =
      scene_report({.folders = {write("d", {.has_section = false, .has_row = true}),
                                write("m", {.model = "helscm", .has_section = false, .has_row = true})}});
  const auto page = html_page(made);
  const auto begin = page.find("id=\"profiles\""), end = page.find("id=\"time\"");
  ASSERT_LT(begin, end);
  const auto profiles = page.substr(begin, end - begin), times = page.substr(end);
  const auto count = [](const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
  };

  for (const auto* quantity : {"Volume fraction", "Velocity of the solids along x",
                               "Velocity of the solids along z", "Pressure of the gas"})
    EXPECT_EQ(count(profiles, std::string("<summary>") + quantity + ", 1 place</summary>"), 1u) << quantity;
  EXPECT_EQ(count(profiles, "<summary>"), 4u);
  EXPECT_EQ(count(profiles, "class=\"line truth\""), 4u);
  EXPECT_EQ(count(profiles, "class=\"line s"), 4u);
  EXPECT_EQ(count(profiles, "<details open>"), 1u);
  // Over time from 0 to 1 s: the axis holds all of it.
  EXPECT_THAT(times, HasSubstr("text-anchor=\"middle\">0.5</text>"));
}

TEST_F(Scenes, MistakesAreNamed) {
  const auto dem = write("d", {});
  const auto expect = [&](const std::filesystem::path& other, const std::string& said) {
    EXPECT_ERROR(InputError, said, scene_report({.folders = {dem, other}}));
  };
  expect(folder / "nowhere", "nowhere");
  expect(write("x", {.scene = "another"}), "runs of different scenes");
  const auto damaged = write("y", {});
  folder.write("y/p.vtp", "<Piece NumberOfPoints=\"2\">");
  expect(damaged, "p.vtp");
  folder.write("y/p.vtp", picture_of({}).substr(0, 170));
  expect(damaged, "p.vtp");
  write("y", {});
  folder.write("y/section_s.csv", "time [s],x [m],y [m]\n0,0,0\n");
  expect(damaged, "section_s.csv");
  write("y", {});
  folder.write("y/summary.json", "{}");
  expect(damaged, "summary.json");
  EXPECT_THROW(static_cast<void>(scene_report({})), UsageError);
}

}  // namespace
}  // namespace elrom::report
