#include "elrom/repository/field_files.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::repository {
namespace {

TEST(FieldFiles, AreNamedByTheirDigestAndReadBackWhole) {
  const test::TemporaryFolder folder;
  const FieldFiles files(folder / "fields");

  const auto digest = files.put("abc");

  // FIPS 180-4, example of one block
  EXPECT_EQ(digest, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(files.put("abc"), digest);
  EXPECT_TRUE(files.has(digest));
  EXPECT_EQ(files.read(digest), "abc");
}

TEST(FieldFiles, DamageIsSeen) {
  const test::TemporaryFolder folder;
  const FieldFiles files(folder / "fields");
  const auto digest = files.put("abc");

  test::write_bytes(files.path(digest), "abd");

  EXPECT_ERROR(InputError, "damaged file of fields", files.read(digest));
}

TEST(FieldFiles, ANameThatIsNoDigestLeadsNowhere) {
  const test::TemporaryFolder folder;
  const FieldFiles files(folder / "fields");

  for (const std::string name : {"", "../../etc/passwd", "abc"})
    EXPECT_ERROR(UsageError, "no digest", files.path(name));
  EXPECT_ERROR(UsageError, "no digest", files.path(std::string(64, 'A')));
  EXPECT_FALSE(files.has(std::string(64, 'a')));
}

}  // namespace
}  // namespace elrom::repository
