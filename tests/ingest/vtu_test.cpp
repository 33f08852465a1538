#include "vtu.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"
#include "vtu_file.hpp"

namespace elrom::ingest {
namespace {

using ::testing::HasSubstr;
using Format = test::VtuStyle::Format;

class Vtu : public ::testing::Test {
 protected:
  CellSet read(const std::string& text) { return read_vtu(folder_.write("a.vtu", text)); }
  void expect_refused(const std::string& text, const std::string& message) {
    EXPECT_ERROR(InputError, message, read(text));
  }
  static std::string with(std::string text, const std::string& part, const std::string& replacement) {
    const auto at = text.find(part);
    EXPECT_NE(at, std::string::npos) << part;
    return text.replace(at, part.size(), replacement);
  }

  test::TemporaryFolder folder_;
};

TEST_F(Vtu, CellsOfEveryShapeHaveHandValues) {
  const auto cells = read(test::VtuFile().text());

  ASSERT_EQ(cells.centre.rows(), 4);
  EXPECT_EQ(cells.points.rows(), 15);
  EXPECT_THAT(cells.volume,
              ::testing::Pointwise(::testing::DoubleEq(), std::vector<double>{2, 0.5, 2, 1.0 / 6}));
  EXPECT_TRUE(cells.centre.row(0).isApprox(Eigen::RowVector3d(0.5, 0.5, 1)));
  EXPECT_TRUE(cells.centre.row(1).isApprox(Eigen::RowVector3d(1.0 / 3, 0.5, 7.0 / 3)));
  EXPECT_TRUE(cells.centre.row(2).isApprox(Eigen::RowVector3d(1.6, 0.5, 1)));
  EXPECT_TRUE(cells.centre.row(3).isApprox(Eigen::RowVector3d(9.25, 0.25, 0.25)));
  const std::vector<std::int32_t> hexahedron(cells.corners.begin(), cells.corners.begin() + 8);
  EXPECT_THAT(hexahedron, ::testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
}

TEST_F(Vtu, EveryWayToHoldArraysGivesTheSameCells) {
  const auto expected = read(test::VtuFile().text());
  for (const auto format : {Format::inline_base64, Format::appended_base64, Format::appended_raw}) {
    for (const bool compressed : {false, true}) {
      for (const bool long_header : {false, true}) {
        const auto cells = read(test::VtuFile({format, compressed, long_header}).text());

        EXPECT_EQ(cells.centre, expected.centre);
        EXPECT_EQ(cells.points, expected.points);
        EXPECT_EQ(cells.corners, expected.corners);
        EXPECT_EQ(cells.volume, expected.volume);
      }
    }
  }
}

TEST_F(Vtu, FlatCellsCountAsOneMetreDeep) {
  test::VtuFile file;
  file.points = {0, 0, 0, 2, 0, 0, 0, 0, 3, 2, 0, 3};
  file.connectivity = {0, 1, 2, 3, 0, 1, 3};
  file.offsets = {4, 7};
  file.types = {8, 5};

  EXPECT_THAT(read(file.text()).volume, ::testing::ElementsAre(6, 3));
}

TEST_F(Vtu, WhatIsNotReadIsRefusedWithTheWayOut) {
  const auto text = test::VtuFile().text();
  test::VtuFile polyhedron;
  polyhedron.types[3] = 42;

  expect_refused(polyhedron.text(), "cell 3: found VTK type 42");
  expect_refused(polyhedron.text(), "Tetrahedralize");
  expect_refused(with(text, "UnstructuredGrid\" version", "PolyData\" version"), "type UnstructuredGrid");
  expect_refused(with(text, "LittleEndian", "BigEndian"), "byte order");
  expect_refused(with(text, "<VTKFile", "<VTKFile compressor=\"vtkLZ4DataCompressor\""), "ZLib");
  expect_refused(with(text, "</Piece>", "</Piece><Piece/>"), "found 2, expected one");
}

TEST_F(Vtu, DamagedFilesAreRefusedByPlace) {
  const auto text = test::VtuFile().text();
  test::VtuFile astray, backwards, short_cell, flat;
  astray.connectivity[4] = 15;
  backwards.offsets[1] = 7;
  short_cell.offsets[0] = 7;
  for (std::size_t i = 2; i < flat.points.size(); i += 3) flat.points[i] = 0;

  expect_refused(astray.text(), "a corner that is no point");
  expect_refused(backwards.text(), "offsets");
  expect_refused(short_cell.text(), "cell 0: found 7, expected 8");
  expect_refused(flat.text(), "a cell without volume");
  expect_refused(text.substr(0, text.size() / 2), "a.vtu:4");
  expect_refused(with(text, "Name=\"types\"", "Name=\"kinds\""), "array 'types'");
  expect_refused(with(text, "NumberOfCells=\"4\"", "NumberOfCells=\"5\""), "found 4 values, expected 5");
  expect_refused(with(text, "NumberOfCells=\"4\"", "NumberOfCells=\"1e99\""), "a whole number");
  expect_refused(with(text, "<VTKFile", "<!DOCTYPE a [<!ENTITY b \"c\">]><VTKFile"), "a document type");
  expect_refused("", "not a .vtu file");
}

TEST_F(Vtu, DamagedBytesAreRefused) {
  const auto inlined = test::VtuFile({Format::inline_base64, true, false}).text();
  const auto appended = test::VtuFile({Format::appended_raw, false, false}).text();

  const auto at = inlined.find("binary\">") + 80;
  expect_refused(inlined.substr(0, at) + "*" + inlined.substr(at + 1), "expected base64");
  expect_refused(inlined.substr(0, at) + "AAAA" + inlined.substr(at + 4), "array 'points'");
  expect_refused(with(appended, "offset=\"0\"", "offset=\"1\""), "damaged array");
  expect_refused(with(appended, "offset=\"0\"", "offset=\"99999\""), "a place in the appended data");
  expect_refused(with(appended, "NumberOfPoints=\"15\"", "NumberOfPoints=\"1999999999\""), "a smaller file");
}

}  // namespace
}  // namespace elrom::ingest
