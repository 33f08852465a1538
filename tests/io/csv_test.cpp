#include "elrom/io/csv.hpp"

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
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

TEST(Csv, TheSeparatorIsWhatTheHeadingsHaveMostOf) {
  EXPECT_THAT(parse_csv("case;load;\"a, or b\";c\nx;1;2,5;3\n", "t.csv").rows,
              ElementsAre(ElementsAre("x", "1", "2,5", "3")));
}

TEST(Csv, AnotherSeparatorThanTheHeadingsHaveIsNamed) {
  EXPECT_ERROR(
      InputError,
      "wrong number of cells in t.csv:2: found 1 cell, expected 2; the headings are separated by commas and "
      "this line by semicolons",
      parse_csv("a,b\n1;2\n", "t.csv"));
  EXPECT_ERROR(InputError, "separated by semicolons and this line by tabs",
               parse_csv("a;b\n1\t2\n", "t.csv"));
}

TEST(Csv, ADecimalCommaAmongCommasIsNamed) {
  EXPECT_ERROR(
      InputError,
      "found 3 cells, expected 2; commas separate here: write numbers with a decimal point, or separate by "
      "semicolons",
      parse_csv("a,b\n180,5,2\n", "t.csv"));
  EXPECT_ERROR(InputError,
               "no finite number in t.csv:2, column 'a': found '180,5'; write numbers with a decimal point",
               parse_csv("a,b\n\"180,5\",2\n", "t.csv").quantity(0, 0));
}

/// "a [µm];b" and a line, as spreadsheets save it.
TEST(Csv, FilesAreReadInTheEncodingsOfSpreadsheets) {
  const test::TemporaryFolder folder;
  const auto utf16 = [](std::u16string_view text, bool little) {
    std::string bytes = little ? "\xff\xfe" : "\xfe\xff";
    for (const char16_t c : text) {
      const char low = static_cast<char>(c & 0xff), high = static_cast<char>(c >> 8);
      bytes += little ? low : high;
      bytes += little ? high : low;
    }
    return bytes;
  };
  const std::pair<std::string, std::string> encodings[] = {
      {"utf-8", "a [\u00b5m];b\nx\U0001f525;2\n"},
      {"utf-8 with a mark",
       "\xef\xbb\xbf"
       "a [\u00b5m];b\nx\U0001f525;2\n"},
      {"utf-16 little", utf16(u"a [\u00b5m];b\nx\U0001f525;2\n", true)},
      {"utf-16 big", utf16(u"a [\u00b5m];b\nx\U0001f525;2\n", false)}};
  for (const auto& [name, bytes] : encodings) {
    const auto table = read_csv(folder.write("t.csv", bytes));
    EXPECT_THAT(table.headings, ElementsAre("a [\u00b5m]", "b")) << name;
    EXPECT_THAT(table.rows, ElementsAre(ElementsAre("x\U0001f525", "2"))) << name;
  }
  EXPECT_THAT(read_csv(folder.write("t.csv",
                                    "a [\xb5m],b [\xb0"
                                    "C]\n1,2\n"))
                  .headings,
              ElementsAre("a [\u00b5m]", "b [\u00b0C]"))
      << "Latin-1";
  EXPECT_ERROR(InputError, "'CSV UTF-8'", read_csv(folder.write("t.csv", std::string("a\0b\0", 4))));
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
