#include <gmock/gmock.h>

#include <cmath>

#include "base64.hpp"
#include "colour_map.hpp"
#include "elrom/report/figures.hpp"
#include "svg.hpp"

namespace elrom::report {
namespace {

TEST(Base64, MatchesTheVectorsOfTheStandard) {
  const auto encode = [](const std::string& text) {
    return base64(std::vector<std::uint8_t>(text.begin(), text.end()));
  };

  // RFC 4648, section 10.
  EXPECT_EQ(encode(""), "");
  EXPECT_EQ(encode("f"), "Zg==");
  EXPECT_EQ(encode("fo"), "Zm8=");
  EXPECT_EQ(encode("foo"), "Zm9v");
  EXPECT_EQ(encode("foobar"), "Zm9vYmFy");
}

TEST(ColourMap, SequentialRisesEvenlyInLightness) {
  const auto map = sequential_map();
  const double step = (lightness(map[255]) - lightness(map[0])) / 255;

  EXPECT_GT(step, 0);
  constexpr double rounding = 0.6;  // of a step: colours have 8 bits
  for (std::size_t i = 0; i < 255; i += 5) {
    const double expected = lightness(map[0]) + step * static_cast<double>(i);
    EXPECT_NEAR(lightness(map[i]), expected, rounding * step + 0.004) << i;
  }
}

TEST(ColourMap, DivergingIsEquallyDarkAtBothEndsAndLightBetween) {
  const auto map = diverging_map();

  EXPECT_NEAR(lightness(map[0]), lightness(map[255]), 0.01);
  EXPECT_GT(lightness(map[127]), 0.95);
  EXPECT_GT(map[0].b, map[0].r);
  EXPECT_GT(map[255].r, map[255].b);
}

TEST(SvgAxis, TicksAreRoundNumbersInsideTheAxis) {
  EXPECT_THAT(svg::ticks({"", 0, 1}, 5),
              testing::ElementsAre(0, testing::DoubleEq(0.2), testing::DoubleEq(0.4),
                                   testing::DoubleNear(0.6, 1e-12), testing::DoubleEq(0.8), 1));
  EXPECT_THAT(svg::ticks({"", -30, 47}, 4), testing::ElementsAre(-20, 0, 20, 40));
  EXPECT_THAT(svg::ticks({"", 1e-5, 0.2, svg::Scale::log}, 5),
              testing::ElementsAre(testing::DoubleEq(1e-5), testing::DoubleEq(1e-4), testing::DoubleEq(1e-3),
                                   testing::DoubleEq(1e-2), testing::DoubleEq(1e-1)));
}

TEST(SvgAxis, FitsLogarithmicallyOnlyWhatIsPositiveOverDecades) {
  EXPECT_EQ(svg::fit_axis("", std::vector{1e-5, 0.1}, 2.0).scale, svg::Scale::log);
  EXPECT_EQ(svg::fit_axis("", std::vector{0.0, 0.1}, 2.0).scale, svg::Scale::linear);
  EXPECT_EQ(svg::fit_axis("", std::vector{0.05, 0.1}, 2.0).scale, svg::Scale::linear);
  const auto constant = svg::fit_axis("", std::vector{3.0, 3.0});
  EXPECT_LT(constant.low, constant.high);
}

TEST(SvgChart, BreaksALineWhereAValueIsMissing) {
  svg::Chart chart({}, {"x", 0, 3}, {"y", 0, 1}, "test");
  const std::vector<double> x{0, 1, 2, 3}, y{0.5, std::nan(""), 0.5, 0.6};

  chart.line(x, y, "s0", "gap");

  const auto text = chart.text();
  const auto path = text.substr(text.find("class=\"line s0\""));
  EXPECT_EQ(std::count(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(path.find("</path>")), 'M'),
            2);
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("nan")));
}

// A frame of 150 x 100 pixels from (50, 10) on, so that places are easy to tell.
constexpr svg::Size small_chart{
    .width = 220, .height = 150, .left = 50, .right = 20, .top = 10, .bottom = 40};

TEST(SvgChart, DrawsEachShapeWhereItsValuesLie) {
  svg::Chart chart(small_chart, {"x", 0, 10}, {"y", 0, 1}, "test");
  const std::vector<double> x{0, 10}, y{0, 1}, low{2, std::nan("")}, high{4, 6};

  chart.line(x, y, "s0", "a");
  chart.points(std::vector{5.0}, std::vector{0.25}, "s1", "b");
  chart.band(low, high, y, "s2", "c");
  chart.whisker(2, 0.1, 0.3, "s3");
  chart.box(2, 4, 0.5, 0.75, "s4", "d", 0.5);
  chart.dots(x, y, "s5", "e");
  chart.tile(4, 6, 0, 0.5, "#123456", "f");
  for (const auto* anchor : {"start", "middle", "end"}) chart.label(5, 0.5, "l", anchor);

  const auto text = chart.text();
  for (const auto* shape :
       {"<path class=\"line s0\" d=\"M50 110L200 10\"><title>a</title></path>",
        "<circle class=\"point s1\" cx=\"125\" cy=\"85\" r=\"3.5\"><title>b: 5, 0.25</title></circle>",
        "<path class=\"band s2\" d=\"M80 110L50 10L140 10L110 110Z\"><title>c</title></path>",
        "<path class=\"line s3\" d=\"M80 100V80\"/>",
        "<rect class=\"fill s4\" x=\"80\" y=\"35\" width=\"30\" height=\"25\" opacity=\"0.500\">",
        "<path class=\"dots s5\" d=\"M50 110h0M200 10h0\">",
        "<rect fill=\"#123456\" x=\"110\" y=\"60\" width=\"30\" height=\"50\"><title>f</title></rect>",
        "<text class=\"label\" x=\"132\" y=\"64\" text-anchor=\"start\">l</text>",
        "<text class=\"label\" x=\"125\" y=\"64\" text-anchor=\"middle\">l</text>",
        "<text class=\"label\" x=\"118\" y=\"64\" text-anchor=\"end\">l</text>"})
    EXPECT_THAT(text, testing::HasSubstr(shape));
}

TEST(SvgChart, AxesHaveTicksLabelsAndAFrame) {
  const auto text = svg::Chart(small_chart, {"across", 0, 10}, {"up", 0, 1}, "test").text();

  for (
      const auto* part :
      {"viewBox=\"0 0 220 150\"", "aria-label=\"test\"", "<path class=\"frame\" d=\"M50 10V110H200\"/>",
       "<path class=\"grid\" d=\"M125 10V110\"/><text class=\"tick\" x=\"125\" y=\"125\" text-anchor=\"middle\">5</text>",
       "<path class=\"grid\" d=\"M50 60H200\"/><text class=\"tick\" x=\"44\" y=\"64\" text-anchor=\"end\">0.5</text>",
       "<text class=\"axis\" x=\"125\" y=\"144\" text-anchor=\"middle\">across</text>",
       "translate(13 60) rotate(-90)"})
    EXPECT_THAT(text, testing::HasSubstr(part));
}

TEST(SvgChart, CutsOffAtTheFrameWhereItIsAskedTo) {
  auto size = small_chart;
  EXPECT_THAT(svg::Chart(size, {"", 0, 1}, {"", 0, 1}, "t").text(),
              testing::Not(testing::HasSubstr("viewBox=\"50 10 150 100\"")));
  size.clip = true;
  EXPECT_THAT(
      svg::Chart(size, {"", 0, 1}, {"", 0, 1}, "t").text(),
      testing::HasSubstr("<svg x=\"50\" y=\"10\" width=\"150\" height=\"100\" viewBox=\"50 10 150 100\">"));
}

// 100 pixels for the longest.
TEST(SvgBars, PartsStandSideBySideUnderTheirNames) {
  const auto text = svg::bars({{"one", {{1, "a", "first"}, {1, "b", ""}}, "two in all"},
                               {"lost", {{std::nan(""), "a", ""}, {0.5, "b", ""}}, "half"}},
                              "error", "test", 392);

  for (
      const auto* part :
      {"<text class=\"name\" x=\"164\" y=\"23\" text-anchor=\"end\">one</text>",
       "<rect class=\"fill a\" x=\"172\" y=\"11\" width=\"50\" height=\"16\"><title>first</title></rect>",
       "<rect class=\"fill b\" x=\"222\" y=\"11\" width=\"50\" height=\"16\"></rect>",
       "<text class=\"label\" x=\"279\" y=\"23\">two in all</text>",
       "<rect class=\"fill b\" x=\"172\" y=\"37\" width=\"25\" height=\"16\"></rect>",
       "<path class=\"frame\" d=\"M172 6V58\"/><text class=\"axis\" x=\"222\" y=\"92\" text-anchor=\"middle\">error</text>",
       "viewBox=\"0 0 392 98\""})
    EXPECT_THAT(text, testing::HasSubstr(part));
}

TEST(SvgAxis, LabelsAreShort) {
  for (const auto& [value, label] : std::vector<std::pair<double, std::string>>{{0, "0"},
                                                                                {0.25, "0.25"},
                                                                                {-12, "-12"},
                                                                                {1e-3, "0.001"},
                                                                                {5e-4, "5e-4"},
                                                                                {99999, "1e+05"},
                                                                                {1e5, "1e5"},
                                                                                {-2.5e-6, "-2.5e-6"}})
    EXPECT_EQ(svg::tick_label(value), label);
}

TEST(SvgAxis, LogarithmsOfLessThanTwoDecadesHaveOneTwoAndFive) {
  EXPECT_THAT(svg::ticks({"", 0.15, 3, svg::Scale::log}, 5),
              testing::ElementsAre(testing::DoubleNear(0.2, 1e-12), testing::DoubleNear(0.5, 1e-12),
                                   testing::DoubleNear(1, 1e-12), testing::DoubleNear(2, 1e-12)));
}

TEST(SvgChart, TextIsEscaped) {
  const svg::Chart chart({}, {"a < b", 0, 1}, {"y & z", 0, 1}, "\"quoted\"");

  EXPECT_THAT(chart.text(), testing::AllOf(testing::HasSubstr("a &lt; b"), testing::HasSubstr("y &amp; z"),
                                           testing::HasSubstr("&quot;quoted&quot;")));
}

// 3 columns along x, 2 along y, 2 planes.
field::Mesh small_mesh() { return field::make_furnace_mesh({.bottom_width_m = 10.6}, 3, 2, 2); }

TEST(Figures, MiddleCutsFollowTheGridOfColumns) {
  const auto cuts = middle_cuts(small_mesh());

  ASSERT_EQ(cuts.size(), 2u);
  EXPECT_EQ(cuts[0].cells.size(), 3u * 2);  // along x, in both planes
  EXPECT_EQ(cuts[1].cells.size(), 2u * 2);
  EXPECT_THAT(cuts[0].cells[0], testing::ElementsAre(0, 3));  // between the two rows along y
  EXPECT_THAT(cuts[1].cells[0], testing::ElementsAre(1, 1));  // the middle of three columns
  EXPECT_EQ(cuts[0].title, "y = 13.80 m");
  EXPECT_EQ(cuts[1].title, "x = 5.30 m");
}

TEST(Figures, QuadrilateralsTileTheCut) {
  for (const auto& cut : middle_cuts(small_mesh())) {
    double area = 0;
    for (const auto& q : cut.corners)  // shoelace formula
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t a = 2 * k, b = 2 * ((k + 1) % 4);
        area += 0.5 * (double{q[a]} * q[b + 1] - double{q[b]} * q[a + 1]);
      }
    EXPECT_NEAR(area, 47 * (cut.horizontal == "x [m]" ? 10.6 : 27.6), 1e-2) << cut.title;
  }
}

TEST(Figures, AMeshInOnePlaneIsCutThroughItsCells) {
  auto mesh = field::make_furnace_mesh({.bottom_width_m = 10.6}, 3, 3, 2);
  mesh.n_planes = 1;
  mesh.n_columns = 18;

  const auto cuts = middle_cuts(mesh);

  ASSERT_EQ(cuts.size(), 2u);
  EXPECT_EQ(cuts[0].title, "y = 13.80 m");
  EXPECT_EQ(cuts[0].cells.size(), 6u);
  EXPECT_THAT(cuts[0].cells[0], testing::ElementsAre(3, 3));
  EXPECT_FLOAT_EQ(cuts[0].corners[0][4], 10.6F / 3);  // right, top
  EXPECT_FLOAT_EQ(cuts[0].corners[0][5], 23.5F);
}

TEST(Figures, AFlatMeshIsShownWhole) {
  auto mesh = field::make_furnace_mesh({.bottom_width_m = 10.6}, 3, 2, 1);
  const auto drawn = middle_cuts(mesh);
  mesh.points = mesh.centre;  // only centres are known: cells are points
  for (std::size_t i = 0; i < mesh.corners.size(); ++i) mesh.corners[i] = static_cast<std::int32_t>(i / 8);
  const auto as_points = middle_cuts(mesh);

  ASSERT_EQ(drawn.size(), 1u);
  EXPECT_EQ(drawn[0].cells.size(), 6u);
  EXPECT_EQ(drawn[0].title, "z = 23.50 m");
  EXPECT_EQ(drawn[0].vertical, "y [m]");
  ASSERT_EQ(as_points.size(), 1u);
  EXPECT_EQ(as_points[0].cells, drawn[0].cells);
  EXPECT_GT(as_points[0].corners[0][2], as_points[0].corners[0][0]);
}

TEST(Figures, CutsBetweenTwoRowsShowTheirMean) {
  const auto cuts = middle_cuts(small_mesh());
  std::vector<float> cells(12);
  for (std::size_t i = 0; i < cells.size(); ++i) cells[i] = static_cast<float>(i);

  const auto values = on_cuts(cuts, cells);

  EXPECT_FLOAT_EQ(values[0], 1.5F);  // mean of cells 0 and 3
  EXPECT_FLOAT_EQ(values[6], 1.0F);  // first of the second cut: cell 1
}

TEST(Figures, PlaneMeansAreVolumeWeighted) {
  auto mesh = small_mesh();
  mesh.volume[0] = 3 * mesh.volume[1];
  for (std::size_t i = 1; i < 6; ++i) mesh.volume[i] = mesh.volume[1];
  std::vector<float> cells(12, 0.0F);
  cells[0] = 8;

  EXPECT_NEAR(plane_means(mesh, cells)[0], 8.0 * 3 / 8, 1e-6);
}

TEST(Histogram, CountsOutliersInTheEndBins) {
  Histogram histogram(-1, 1, 4);
  for (const double value : {-5.0, -0.9, 0.1, 0.6, 7.0}) histogram.add(value);

  EXPECT_THAT(histogram.counts, testing::ElementsAre(2, 0, 1, 2));
  EXPECT_EQ(histogram.total(), 5u);
}

TEST(Svg, DotsAreOnePathAndLeaveOutWhatIsNoNumber) {
  svg::Chart chart({.width = 110, .height = 110, .left = 0, .right = 10, .top = 10, .bottom = 0}, {"x", 0, 1},
                   {"y", 0, 1}, "t");
  chart.dots(std::vector{0.0, 0.5, std::nan("")}, std::vector{0.0, 1.0, 0.5}, "s0", "group");
  chart.tile(0, 0.5, 0, 0.25, "#102030", "tip");
  EXPECT_THAT(chart.text(), testing::HasSubstr("<path class=\"dots s0\" d=\"M0 110h0M50 10h0\">"));
  EXPECT_THAT(chart.text(),
              testing::HasSubstr("<rect fill=\"#102030\" x=\"0\" y=\"85\" width=\"50\" height=\"25\">"));
}

}  // namespace
}  // namespace elrom::report
