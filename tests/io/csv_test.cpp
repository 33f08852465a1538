#include "elrom/io/csv.hpp"

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::io {
namespace {

using ::testing::ElementsAre;

TEST(Csv, ReadsPlainCells) {
  const auto table = parse_csv("case,load\na, 0.5\nb,1 \n", "t.csv");

  EXPECT_THAT(table.headings, ElementsAre("case", "load"));
  EXPECT_THAT(table.rows, ElementsAre(ElementsAre("a", "0.5"), ElementsAre("b", "1")));
}

TEST(Csv, SkipsByteOrderMarkBlankLinesAndComments) {
  const auto table = parse_csv("\xef\xbb\xbf# made by hand\r\ncase\r\n\r\na\r\n", "t.csv");

  EXPECT_THAT(table.headings, ElementsAre("case"));
  EXPECT_THAT(table.rows, ElementsAre(ElementsAre("a")));
  EXPECT_THAT(table.lines, ElementsAre(4));
}

TEST(Csv, QuotedCellsHoldSeparatorsQuotesAndLines) {
  const auto table = parse_csv("a,b\n\"x, \"\"y\"\"\",\"two\nlines\" \nz,w\n", "t.csv");

  EXPECT_THAT(table.rows, ElementsAre(ElementsAre("x, \"y\"", "two\nlines"), ElementsAre("z", "w")));
  EXPECT_THAT(table.lines, ElementsAre(2, 4));
}

TEST(Csv, SemicolonsSeparateWhereTheHeadingHasNoComma) {
  EXPECT_THAT(parse_csv("a;b\n1;2\n", "t.csv").rows, ElementsAre(ElementsAre("1", "2")));
}

TEST(Csv, KeepsEmptyCellsButNoEmptyRows) {
  EXPECT_THAT(parse_csv("a,b,c\n,x,\n,,\n", "t.csv").rows, ElementsAre(ElementsAre("", "x", "")));
}

TEST(Csv, SeparatesByWhatTheFirstLineSaysOrTheHeadingsShow) {
  for (const char* text : {"sep=;\na;b\n1,5;2\n", "a;b\n1,5;2\n", "# a, comment\na\tb\n1,5\t2\n"})
    EXPECT_THAT(parse_csv(text, "t.csv").rows, ElementsAre(ElementsAre("1,5", "2"))) << text;
}

TEST(Csv, NamesTheLineOfARaggedRow) {
  EXPECT_ERROR(InputError, "wrong number of cells in t.csv:3: found 1 cell, expected 2",
               parse_csv("a,b\n1,2\n3\n", "t.csv"));
}

TEST(Csv, RefusesWhatIsNoTable) {
  EXPECT_ERROR(InputError, "empty file", parse_csv("\n\n", "t.csv"));
  EXPECT_ERROR(InputError, "not a text file", parse_csv(std::string_view("a\0b", 3), "t.csv"));
  EXPECT_ERROR(InputError, "never closed in t.csv:2", parse_csv("a\n\"x\ny\n", "t.csv"));
  EXPECT_ERROR(InputError, "after a closing quote", parse_csv("a\n\"x\"y\n", "t.csv"));
}

TEST(Csv, WrittenCellsReadBack) {
  for (const std::string cell : {"plain", "a,b", "say \"x\"", " padded ", "#7", "line\nbreak"}) {
    EXPECT_EQ(parse_csv("h\n" + csv_cell(cell) + "\n", "t.csv").rows.at(0).at(0), cell);
  }
}

}  // namespace
}  // namespace elrom::io
