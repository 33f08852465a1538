#include "elrom/fields/formats.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::fields {
namespace {

TEST(Formats, EveryOneIsFoundByItsNameAndByItself) {
  for (const auto& info : formats()) {
    EXPECT_EQ(format_named(info.name).format, info.format);
    EXPECT_STREQ(info_of(info.format).name, info.name);
  }
}

TEST(Formats, AnUnknownOneNamesTheNearest) {
  EXPECT_ERROR(UsageError, "no format 'hdff'", format_named("hdff"));
  EXPECT_ERROR(UsageError, "'hdf'", format_named("hdff"));
  EXPECT_ERROR(UsageError, "no format '0'", format_named("0"));
}

}  // namespace
}  // namespace elrom::fields
