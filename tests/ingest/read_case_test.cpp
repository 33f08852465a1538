#include <gmock/gmock.h>

#include <fstream>

#include "elrom/base/error.hpp"
#include "elrom/ingest/case_files.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::filesystem::path data = ELROM_SOURCE_DIR "/data";

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

TEST(ReadCase, TellsFormatsByWhatIsThere) {
  EXPECT_EQ(read_case(data / "cases/train_000.h5").record.inputs.name, "train_000");
  EXPECT_EQ(read_case(data / "formats/fluent_ascii/load_064_space.txt.gz").centre.rows(), 500);
  EXPECT_EQ(read_case(data / "formats/instants/case").centre.rows(), 6930);
}

TEST(ReadCase, MissingFilesAndOtherDirectoriesAreRefused) {
  EXPECT_THAT([] { (void)read_case("nowhere.h5"); }, ThrowsMessage<InputError>(HasSubstr("cannot open")));
  EXPECT_THAT([] { (void)read_case(data / "cases"); },
              ThrowsMessage<InputError>(HasSubstr("directory is no case")));
}

// Every length ends in an InputError that names the file; the
// test would die with a crash inside the HDF5 library.
TEST(ReadCase, TruncatedExportsAreRefusedAtEveryLength) {
  const test::TemporaryFolder folder;
  const auto whole = bytes_of(data / "cases/train_000.h5");
  constexpr std::size_t n_lengths = 40;

  for (std::size_t i = 0; i < n_lengths; ++i) {
    const auto path = folder.write("cut.h5", whole.substr(0, whole.size() * i / n_lengths));
    EXPECT_THAT([&] { (void)read_case(path); }, ThrowsMessage<InputError>(HasSubstr("cut.h5")))
        << "length part " << i;
  }
}

TEST(ReadCase, OnlyStoresAreTakenForStores) {
  const test::TemporaryFolder folder;

  EXPECT_FALSE(is_snapshot_store(data / "cases/train_000.h5"));
  EXPECT_FALSE(is_snapshot_store(data / "cases/cases.csv"));
  EXPECT_FALSE(is_snapshot_store(data / "formats/instants/case"));
}

}  // namespace
}  // namespace elrom::ingest
