#include "tar.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/outcome.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::serve {
namespace {

TEST(Tar, IsUnpackedByTarToTheSameFiles) {
  const test::TemporaryFolder folder;
  folder.write("0/U", std::string(1000, 'u'));
  folder.write("0/lagrangian/cloud/d", "d");
  test::write_bytes(folder / "a.tar", tar_of(folder / "0"));

  const auto unpacked =
      test::outcome_of("cd " + folder.path().string() + " && mkdir out && tar xf a.tar -C out");

  EXPECT_EQ(unpacked.text, "");
  EXPECT_EQ(test::read_bytes(folder / "out/0/U"), std::string(1000, 'u'));
  EXPECT_EQ(test::read_bytes(folder / "out/0/lagrangian/cloud/d"), "d");
}

TEST(Tar, ANameThatIsTooLongIsRefused) {
  const test::TemporaryFolder folder;
  folder.write("0/" + std::string(120, 'n'), "x");

  EXPECT_THROW((void)tar_of(folder / "0"), InputError);
}

}  // namespace
}  // namespace elrom::serve
