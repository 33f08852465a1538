#include "elrom/fields/text_writer.hpp"

#include <gmock/gmock.h>

#include "elrom/base/text.hpp"
#include "support/sample_run.hpp"

namespace elrom::fields {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Coordinates coordinates(const test::SampleRun& sample) {
  const auto& extent = sample.frame.extent;
  return extent.average() ? coordinates_of(*extent.average()) : coordinates_of(*extent.geometry());
}

TEST(CsvWriter, WritesOneRowACellWithUnitsInTheHeadings) {
  const test::SampleRun sample({.planes = {1}});
  std::string text;

  write_csv(sample.frame, coordinates(sample), sample.prediction(), text);

  const auto lines = base::split(text, '\n');
  ASSERT_EQ(lines.size(), 6U);
  EXPECT_EQ(lines[0], "plane,column,x [m],y [m],z [m],pressure [Pa],gas_velocity_z [m/s]");
  EXPECT_THAT(lines[1], StartsWith("1,0,"));
  EXPECT_THAT(lines[1], HasSubstr(",104,204"));
  EXPECT_THAT(lines[4], StartsWith("1,3,"));
  EXPECT_THAT(lines[4], HasSubstr(",107,207"));
}

TEST(CsvWriter, NumbersReadBackToTheSameFloat) {
  test::SampleRun sample({.planes = {1}});
  sample.values[0] = 0.1F;
  sample.values[1] = 1.17549435e-38F;
  sample.values[2] = -3.4028235e38F;
  std::string text;

  write_csv(sample.frame, coordinates(sample), sample.prediction(), text);

  const auto lines = base::split(text, '\n');
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_EQ(std::stof(base::split(lines[row + 1], ',')[5]), sample.values[row]);
  }
}

TEST(CsvWriter, ProfilesHaveOneRowAPlane) {
  test::SampleRun sample({.profile = true});
  sample.values = {1, 2, 3, 4, 5, 6};
  std::string text;

  write_csv(sample.frame, coordinates(sample), sample.prediction(), text);

  const auto lines = base::split(text, '\n');
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0], "plane,z [m],pressure [Pa],gas_velocity_z [m/s]");
  EXPECT_THAT(lines[3], HasSubstr(",3,6"));
}

TEST(Sfw3dWriter, HasACommentedHeaderAndColumnsOfFixedWidth) {
  const test::SampleRun sample({.planes = {2}});
  std::string text;

  write_sfw3d(sample.frame, coordinates(sample), sample.prediction(), text);

  EXPECT_THAT(text, HasSubstr("# case case_a\n# validity inside: as good as trained\n"));
  EXPECT_THAT(text, HasSubstr("# 4 cells; columns: x[m] y[m] z[m] pressure[Pa] gas_velocity_z[m/s]\n"));
  const auto lines = base::split(text, '\n');
  const auto& last = lines[lines.size() - 2];
  EXPECT_EQ(last.size(), 5U * 16);
  EXPECT_EQ(base::trim(last.substr(48, 16)), "1.1100000e+02");
}

TEST(FluentWriter, WritesTheInterpolationFormatVersion3) {
  const test::SampleRun sample({.planes = {0}});
  std::string text;

  write_fluent(sample.frame, coordinates(sample), sample.prediction(), text);

  const auto lines = base::split(text, '\n');
  EXPECT_EQ(base::join({lines.begin(), lines.begin() + 6}, "|"), "3|3|4|2|pressure|z-velocity");
  // x, y, z, then the fields: each opens with its first value, and closes on a line of its own.
  ASSERT_EQ(lines.size(), 6U + 5 * 5 + 1);
  for (std::size_t block = 0; block < 5; ++block) {
    EXPECT_THAT(lines[6 + block * 5], StartsWith("("));
    EXPECT_EQ(lines[6 + block * 5 + 4], ")");
  }
  EXPECT_EQ(lines[6 + 3 * 5], "(1.000000000e+02");
  EXPECT_EQ(lines[6 + 4 * 5 + 3], "2.030000000e+02");
}

}  // namespace
}  // namespace elrom::fields
