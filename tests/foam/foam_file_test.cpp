#include "elrom/foam/foam_file.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::foam {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class FoamFileOf {
 public:
  explicit FoamFileOf(const std::string& text) : path_(folder_.write("x", text)) {}
  [[nodiscard]] FoamFile open() const {
    FoamFile file(path_);
    file.to_body();
    return file;
  }

 private:
  test::TemporaryFolder folder_;
  std::filesystem::path path_;
};

template <class Work>
std::string message_of(const std::string& text, Work work) {
  const FoamFileOf source(text);
  try {
    auto file = source.open();
    work(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(FoamFile, ListsAreReadBehindHeaderAndComments) {
  const FoamFileOf source(
      "/* banner */\nFoamFile{version 2.0;format ascii;class scalarField;}\n// remark\n3\n(1\n2.5e-3\n-4)\n");

  EXPECT_THAT(source.open().scalars(), ElementsAre(1, 2.5e-3, -4));
}

TEST(FoamFile, UniformListsAreExpanded) {
  EXPECT_THAT(FoamFileOf("4{2400}").open().scalars(4), ElementsAre(2400, 2400, 2400, 2400));
  EXPECT_EQ(FoamFileOf("2{(1 2 3)}").open().vectors(2), (MatrixD(2, 3) << 1, 2, 3, 1, 2, 3).finished());
}

TEST(FoamFile, SeekSkipsWholeEntries) {
  const FoamFileOf source("a {wanted 1; b {wanted 2;}}\nlist (wanted (3));\ndims [0 1 0]; wanted 4;");
  auto file = source.open();

  EXPECT_DOUBLE_EQ(file.dictionary_number("wanted"), 4);
}

TEST(FoamFile, AnEntryBehindAUniformListIsFound) {
  const FoamFileOf source("internalField nonuniform List<scalar> 3{0.5};\nboundaryField {}");
  EXPECT_TRUE(source.open().seek("boundaryField"));
}

TEST(FoamFile, AnEntrysValueIsReplacedAndTheRestKept) {
  const FoamFileOf source(
      "FoamFile{class volScalarField;}\ndimensions [0 0 0];\na uniform 1;\nb {wall {value $a;} }\n// end\n");
  auto file = source.open();

  EXPECT_EQ(file.class_name(), "volScalarField");
  EXPECT_EQ(file.body_with("a", "2(7 8)"),
            "\ndimensions [0 0 0];\na 2(7 8);\nb {wall {value uniform 1;} }\n// end\n");
}

TEST(FoamFile, OldStyleDimensionedNumbersAreRead) {
  EXPECT_DOUBLE_EQ(FoamFileOf("rho.air rho.air [1 -3 0 0 0 0 0] 1.2;").open().dictionary_number("rho.air"),
                   1.2);
}

TEST(FoamFile, FaultsAreToldWithTheirLine) {
  EXPECT_THAT(message_of("FoamFile{format binary;}\n", [](FoamFile&) {}), HasSubstr("format binary"));
  EXPECT_THAT(message_of("2\n(1\nx)", [](FoamFile& f) { (void)f.scalars(); }),
              AllOf(HasSubstr("x:3"), HasSubstr("'x'")));
  EXPECT_THAT(message_of("3\n(1 2", [](FoamFile& f) { (void)f.scalars(); }), HasSubstr("truncated"));
  EXPECT_THAT(message_of("3(1 2 3)", [](FoamFile& f) { (void)f.scalars(2); }),
              HasSubstr("expected 2 entries"));
  EXPECT_THAT(message_of("1(1e999)", [](FoamFile& f) { (void)f.scalars(); }), HasSubstr("finite number"));
  EXPECT_THAT(message_of("a 1;", [](FoamFile& f) { f.seek_required("b"); }), HasSubstr("no entry 'b'"));
}

TEST(FoamFile, AListThatTheFileCannotHoldCostsNoMemory) {
  EXPECT_THAT(message_of("999999999999(1 2)", [](FoamFile& f) { (void)f.scalars(); }),
              HasSubstr("truncated"));
}

}  // namespace
}  // namespace elrom::foam
