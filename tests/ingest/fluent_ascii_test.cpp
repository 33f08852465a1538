#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <tuple>

#include "elrom/base/error.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "hdf5_values.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Property;
using ::testing::ThrowsMessage;

const std::string samples = ELROM_SOURCE_DIR "/data/formats/fluent_ascii/";
const std::string header =
    "cellnumber, x-coordinate, y-coordinate, z-coordinate, solids-x-velocity, solids-y-velocity, "
    "solids-z-velocity, "
    "x-velocity, y-velocity, z-velocity, pressure, solids-diameter, solids-vof\n";

using Position = std::tuple<long, long, long>;
Position millimetres(double x, double y, double z) {
  return {std::lround(x * 1e3), std::lround(y * 1e3), std::lround(z * 1e3)};
}

/// Compares every cell of a Fluent file with the cell of the EL3D export at the same place.
void expect_same_case(const CfdCase& fluent, const std::string& el3d) {
  const auto centre = testing::hdf5_values(el3d, "/mesh/centre");
  std::map<Position, std::size_t> at;
  for (std::size_t i = 0; i < centre.size() / 3; ++i) {
    at[millimetres(centre[3 * i], centre[3 * i + 1], centre[3 * i + 2])] = i;
  }
  for (std::size_t f = 0; f < fluent.fields.size(); ++f) {
    const auto expected = testing::hdf5_values(el3d, "/fields/" + fluent.fields[f].name);
    for (Eigen::Index i = 0; i < fluent.centre.rows(); ++i) {
      const auto cell = at.at(millimetres(fluent.centre(i, 0), fluent.centre(i, 1), fluent.centre(i, 2)));
      const float found = fluent.values(static_cast<Eigen::Index>(f), i);
      // Ten decimal digits hold a float exactly.
      ASSERT_FLOAT_EQ(found, expected[cell]) << fluent.fields[f].name << " cell " << i;
    }
  }
}

TEST(FluentAscii, CommaFileHoldsTheSameCaseAsItsEl3dExport) {
  const auto found = read_fluent_ascii(samples + "train_000_comma.txt.gz");

  EXPECT_EQ(found.record.inputs.name, "train_000_comma");
  EXPECT_EQ(found.centre.rows(), 6930);
  EXPECT_EQ(found.schema.size(), 0u);
  expect_same_case(found, ELROM_SOURCE_DIR "/data/cases/train_000.h5");
}

TEST(FluentAscii, SpaceSeparatedFileHoldsTheSameCaseAsItsEl3dExport) {
  const auto found = read_fluent_ascii(samples + "load_064_space.txt.gz");

  EXPECT_EQ(found.centre.rows(), 500);  // the sample is cut after 500 cells
  expect_same_case(found, ELROM_SOURCE_DIR "/data/cases/load_064.h5");
}

TEST(FluentAscii, UnitsInHeadingsAreConverted) {
  const test::TemporaryFolder folder;
  const auto path =
      folder.write("a.csv",
                   "x [mm],y [m],z [m],volume [m3],solid_velocity_x [cm/s],solid_velocity_y,solid_velocity_z,"
                   "gas_velocity_x,gas_velocity_y,gas_velocity_z [km/h],pressure [kPa],solid_diameter [um],"
                   "solid_volume_fraction [%]\n"
                   "1500,2,3,0.25,50,0,0,0,0,36,1.5,200,12\n");

  const auto found = read_fluent_ascii(path);

  EXPECT_DOUBLE_EQ(found.centre(0, 0), 1.5);
  EXPECT_THAT(found.volume, ::testing::ElementsAre(0.25));
  const std::vector<float> values(found.values.data(), found.values.data() + 9);
  EXPECT_THAT(values, ::testing::Pointwise(::testing::FloatEq(),
                                           {0.5f, 0.f, 0.f, 0.f, 0.f, 10.f, 1500.f, 200e-6f, 0.12f}));
}

TEST(FluentAscii, TabsSeparateAsBlanksDo) {
  const test::TemporaryFolder folder;
  const auto found =
      read_fluent_ascii(folder.write("a.txt", "x [mm]\ty\tz\tpressure [kPa]\n1500\t2\t3\t4\n"));

  EXPECT_DOUBLE_EQ(found.centre(0, 0), 1.5);
  EXPECT_FLOAT_EQ(found.values(0, 0), 4000);
}

std::string message_of(const std::string& text) {
  const test::TemporaryFolder folder;
  const auto path = folder.write("bad.txt", text);
  try {
    (void)read_fluent_ascii(path);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string without(std::string text, std::string_view part, std::string_view replacement = "") {
  return text.replace(text.find(part), part.size(), replacement);
}

TEST(FluentAscii, MissingFieldIsNamedWithTheNearestHeading) {
  const auto message = message_of(without(header, "pressure", "presure") + "1,0,0,0,1,1,1,1,1,1,1,1,1\n");

  EXPECT_THAT(message, AllOf(HasSubstr("missing column 'pressure'"), HasSubstr("is 'presure' meant?")));
}

TEST(FluentAscii, ColumnsWithAUnitAreFieldsOfTheirOwn) {
  const test::TemporaryFolder folder;
  const auto found = read_fluent_ascii(
      folder.write("a.csv", "heat loss [MW],x,y,z,cell number,pressure [kPa],swirl [-]\n2,0,0,0,7,3,4\n"));

  ASSERT_EQ(found.fields.size(), 3u);  // the known one first
  EXPECT_EQ(found.fields[0].name, "pressure");
  EXPECT_EQ(found.fields[1].name, "heat loss");
  EXPECT_EQ(found.fields[1].unit, "W");
  EXPECT_EQ(found.fields[2].unit, "1");
  EXPECT_THAT(std::vector<float>(found.values.data(), found.values.data() + 3),
              ::testing::ElementsAre(3000.f, 2e6f, 4.f));
  EXPECT_THAT(message_of("x,y,z,a/b [Pa]\n0,0,0,1\n"), HasSubstr("no name for a field"));
  EXPECT_THAT(message_of("x,y,z,a [furlong]\n0,0,0,1\n"), HasSubstr("furlong"));
}

TEST(FluentAscii, MissingPlaceIsRefused) {
  EXPECT_THAT(message_of("x,y,pressure\n0,0,1\n"), HasSubstr("missing column 'z-coordinate'"));
}

TEST(FluentAscii, WrongUnitIsRefused) {
  const auto message =
      message_of(without(header, "pressure", "pressure [um]") + "1,0,0,0,1,1,1,1,1,1,1,1,1\n");

  EXPECT_THAT(message, AllOf(HasSubstr("wrong unit of column 'pressure'"), HasSubstr("kPa")));
}

TEST(FluentAscii, BadLinesAreRefusedByNumber) {
  EXPECT_THAT(message_of(header + "1,0,0,0,1,1,1,1,1,1,1,1\n"),
              AllOf(HasSubstr("bad.txt:2"), HasSubstr("found 12")));
  EXPECT_THAT(message_of(header + "1,0,0,0,1,1,1,1,1,1,1,1,1,7\n"), HasSubstr("more than 13"));
  EXPECT_THAT(message_of(header + "1,0,0,0,1,1,1,1,1,1,12bar,1,1\n"), HasSubstr("found '12bar'"));
  EXPECT_THAT(message_of(header + "\n1,0,0,0,1,1,1,1,1,1,nan,1,1\n"),
              AllOf(HasSubstr("bad.txt:3"), HasSubstr("'pressure'")));
  EXPECT_THAT(message_of(header + "1,0,0,0,1,1,1,1,1,1,1e300,1,1\n"), HasSubstr("no finite number"));
}

TEST(FluentAscii, EmptyTablesAndDoubledColumnsAreRefused) {
  EXPECT_THAT(message_of(""), HasSubstr("empty table"));
  EXPECT_THAT(message_of(header), HasSubstr("without cells"));
  EXPECT_THAT(message_of(without(header, "pressure", "pressure, static-pressure") + "1\n"),
              HasSubstr("'pressure' and 'static-pressure'"));
}

TEST(FluentAscii, TruncatedGzipIsRefused) {
  std::ifstream whole(samples + "train_000_comma.txt.gz", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(whole)), std::istreambuf_iterator<char>());

  EXPECT_THAT(message_of(bytes.substr(0, bytes.size() / 2)), HasSubstr("truncated gzip"));
}

}  // namespace
}  // namespace elrom::ingest
