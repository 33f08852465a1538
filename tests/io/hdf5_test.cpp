#include "elrom/io/hdf5.hpp"

#include <fstream>
#include <numeric>

#include "elrom/base/digest.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::io {
namespace {

using ::testing::ElementsAre;

template <class T>
std::vector<T> counting(std::size_t n) {
  std::vector<T> values(n);
  std::iota(values.begin(), values.end(), T{0});
  return values;
}

TEST(Hdf5, NumbersReadBackInAnyType) {
  test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  file.create_group("g").write<float>("x", std::vector<float>{1, 2, 3, 4, 5, 6}, {2, 3});
  file.close();

  const auto dataset = Hdf5File::open(folder / "a.h5").dataset("g/x");

  EXPECT_THAT(dataset.shape(), ElementsAre(2, 3));
  EXPECT_THAT(dataset.read<double>(), ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(dataset.read<std::uint8_t>(), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Hdf5, AttributesReadBack) {
  test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  file.set_text("Type", "UnstructuredGrid");
  file.set_text("empty", "");
  file.set_texts("names", {"one", "three", "\xc2\xb5m"});
  file.set_number("window", 24.5);
  file.set_integers("format", std::vector<std::int64_t>{1, 2});

  EXPECT_EQ(file.text("Type"), "UnstructuredGrid");
  EXPECT_EQ(file.text("empty"), "");
  EXPECT_THAT(file.texts("names"), ElementsAre("one", "three", "\xc2\xb5m"));
  EXPECT_EQ(file.number("window"), 24.5);
  EXPECT_THAT(file.numbers("format"), ElementsAre(1, 2));
  EXPECT_ERROR(InputError, "missing attribute 'unit'", file.text("unit"));
  EXPECT_ERROR(InputError, "is not a number", file.number("Type"));
  EXPECT_ERROR(InputError, "not a text", file.text("window"));
}

TEST(Hdf5, ReadsVariableLengthTextOfOtherPrograms) {
  const auto file = Hdf5File::open(ELROM_SOURCE_DIR "/data/cases/load_064.h5");

  EXPECT_EQ(file.text("case"), "load_064");
  EXPECT_EQ(file.dataset("boundary_conditions").texts("units").at(0), "kg/s");
}

TEST(Hdf5, SlabsReadAndWritePartsOfAGrowingDataset) {
  test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  const auto dataset = file.create<float>(
      "x", {0, 4}, {.chunk = {1, 4}, .deflate = 1, .shuffle = true, .fletcher32 = true, .extendable = true});
  for (std::size_t row = 0; row < 3; ++row) {
    dataset.extend(row + 1);
    const auto base = static_cast<float>(10 * row);
    dataset.write_slab<float>({row, 0}, {1, 4}, std::vector<float>{base, base + 1, base + 2, base + 3});
  }

  std::vector<float> part(4);
  dataset.read_slab<float>({1, 1}, {2, 2}, part);

  EXPECT_THAT(part, ElementsAre(11, 12, 21, 22));
  EXPECT_ERROR(InputError, "outside the dataset in " + (folder / "a.h5").string() + ":x",
               dataset.read_slab<float>({2, 0}, {2, 2}, part));
}

TEST(Hdf5, NamesFileAndDatasetOfAWrongShape) {
  test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  file.create_group("mesh").write<float>("volume", counting<float>(6), {2, 3});

  EXPECT_ERROR(InputError, "a.h5:mesh/volume: found 2 x 3, expected any x 4",
               file.dataset("mesh/volume").expect_shape({0, 4}));
  EXPECT_NO_THROW(file.dataset("mesh/volume").expect_shape({0, 3}));
}

TEST(Hdf5, SuggestsTheNearestName) {
  test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  file.write<float>("pressure", counting<float>(2));

  EXPECT_ERROR(InputError, "did you mean 'pressure'?", file.dataset("presure"));
  EXPECT_FALSE(file.has("pressure/x"));
  EXPECT_TRUE(file.has("/pressure"));
}

TEST(Hdf5, HardLinksShareOneDataset) {
  test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  file.create_group("ours").write<float>("x", counting<float>(3));
  file.create_group("view").hard_link("/ours/x", "y");

  EXPECT_THAT(file.dataset("view/y").read<float>(), ElementsAre(0, 1, 2));
}

TEST(Hdf5, AFlippedByteInACheckedChunkIsAnError) {
  test::TemporaryFolder folder;
  const auto path = folder / "a.h5";
  const std::vector<float> marker(1000, 1.2345678F);
  {
    auto file = Hdf5File::create(path);
    file.write<float>("x", marker, {}, {.chunk = {1000}, .fletcher32 = true});
    file.close();
  }
  std::fstream stream(path, std::ios::in | std::ios::out | std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const auto at = bytes.find(std::string_view(reinterpret_cast<const char*>(marker.data()), 400));
  ASSERT_NE(at, std::string::npos);
  stream.clear();
  stream.seekp(static_cast<std::streamoff>(at) + 101);
  stream.put('\x55');
  stream.close();

  EXPECT_ERROR(InputError, "a.h5:x", Hdf5File::open(path).dataset("x").read<float>());
}

TEST(Hdf5, AHugeClaimWithoutDataIsRefusedBeforeMemoryIsTaken) {
  test::TemporaryFolder folder;
  auto file = Hdf5File::create(folder / "a.h5");
  const auto dataset = file.create<float>("x", {std::size_t{1} << 40}, {.chunk = {1024}, .deflate = 1});

  EXPECT_ERROR(InputError, "claims more values than it holds", dataset.read<float>());
}

TEST(Hdf5, RefusesWhatIsNoHdf5) {
  test::TemporaryFolder folder;
  std::ofstream(folder / "text.h5") << "hello";

  EXPECT_ERROR(InputError, "no such file", Hdf5File::open(folder / "none.h5"));
  EXPECT_ERROR(InputError, "not a file", Hdf5File::open(folder.path()));
  EXPECT_ERROR(InputError, "not a readable HDF5 file", Hdf5File::open(folder / "text.h5"));
}

TEST(Hdf5, ReportsAFullDevice) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";

  EXPECT_ERROR(SystemError, "/dev/full", [] {
    auto file = Hdf5File::create("/dev/full");
    file.write<float>("x", counting<float>(100000));
    file.close();
  }());
}

TEST(Hdf5, TheSameContentGivesTheSameBytes) {
  test::TemporaryFolder folder;
  for (const auto* name : {"a.h5", "b.h5"}) {
    auto file = Hdf5File::create(folder / name);
    file.create_group("g").write<double>("x", counting<double>(100), {}, Hdf5Storage::packed({100}));
    file.close();
  }

  EXPECT_EQ(base::sha256_file(folder / "a.h5"), base::sha256_file(folder / "b.h5"));
}

TEST(Hdf5, PackedChunksStaySmall) {
  EXPECT_THAT(Hdf5Storage::packed({3, 5}).chunk, ElementsAre(3, 5));
  const auto chunk = Hdf5Storage::packed({1000, 2000, 30}).chunk;
  EXPECT_LE(chunk[0] * chunk[1] * chunk[2], std::size_t{1} << 20);
}

}  // namespace
}  // namespace elrom::io
