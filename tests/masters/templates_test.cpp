#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "elrom/masters/foreign_program.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::masters {
namespace {

TemplateValues sample_values() {
  return {.case_name = "el3d_1",
          .load = 0.5,
          .schema = field::InputSchema({{"primary_air", "kg/s", "kg/s"}, {"gas_temperature", "K", "K"}}),
          .inputs = {180, 1123.15},
          .document = R"({"primary_air [kg/s]":180})"};
}

std::string filled(const std::string& text) { return fill_blanks(text, sample_values(), "file"); }

TEST(Templates, BlanksAreFilledInAnyUnitOfTheirDimension) {
  EXPECT_EQ(filled("a {{primary_air}} {{ primary_air [t/h] }} {{gas_temperature [degC]}} {b}"),
            "a 180 648 850 {b}");
  EXPECT_EQ(filled("{{case}} {{load}} {{inputs}}"), R"(el3d_1 0.5 {"primary_air [kg/s]":180})");
  EXPECT_EQ(filled("{{ not closed"), "{{ not closed");
}

TEST(Templates, WrongBlanksAreNamed) {
  EXPECT_ERROR(InputError, "did you mean 'primary_air'?", filled("{{primary_ar}}"));
  EXPECT_ERROR(InputError, "another dimension for 'primary_air' in file: found K, expected kg/s",
               filled("{{primary_air [K]}}"));
  auto values = sample_values();
  values.load.reset();
  EXPECT_ERROR(InputError, "does not tell its load", (void)fill_blanks("{{load}}", values, "file"));
}

TEST(Templates, AFolderIsCopiedAndItsInFilesFilled) {
  const test::TemporaryFolder folder;
  const auto script = folder.write("from/sub/run.in", "echo {{case}}\n");
  folder.write("from/plain", "{{case}}");
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);

  fill_templates(folder / "from", folder / "to/copy", sample_values());

  EXPECT_EQ(test::read_bytes(folder / "to/copy/sub/run"), "echo el3d_1\n");
  EXPECT_EQ(test::read_bytes(folder / "to/copy/plain"), "{{case}}");
  EXPECT_FALSE(std::filesystem::exists(folder / "to/copy/sub/run.in"));
  EXPECT_EQ(std::filesystem::status(folder / "to/copy/sub/run").permissions(),
            std::filesystem::perms::owner_all);
}

}  // namespace
}  // namespace elrom::masters
