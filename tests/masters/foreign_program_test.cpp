#include "elrom/masters/foreign_program.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::masters {
namespace {

struct Description {
  test::TemporaryFolder folder;
  Description() { std::filesystem::create_directory(folder / "templates"); }
  ForeignProgram read(const std::string& more = "") {
    return read_foreign_program(folder.write(
        "program.toml", "name = \"P, v1\"\ntemplates = \"templates\"\ncommand = \"./run\"\n" + more));
  }
};

TEST(ForeignProgram, IsReadWithItsFolderBesideTheFile) {
  Description description;

  const auto program = description.read("needs = [\"sh\"]\ntime_limit_s = 60\ncase = \".\"\n");

  EXPECT_EQ(program.name, "P, v1");
  EXPECT_EQ(program.templates, std::filesystem::absolute(description.folder / "templates"));
  EXPECT_EQ(program.command, "./run");
  EXPECT_EQ(program.time_limit_s, 60);
  EXPECT_EQ(program.cfd_case, ".");
  EXPECT_FALSE(program.document);
  EXPECT_NO_THROW(expect_installed(program));
}

TEST(ForeignProgram, SlipsAreNamedWithFileAndLine) {
  Description description;

  EXPECT_ERROR(UsageError, "did you mean 'needs'?", description.read("need = [\"sh\"]\n"));
  EXPECT_ERROR(UsageError, "program.toml:4", description.read("time_limit_s = 0\n"));
  std::filesystem::remove(description.folder / "templates");
  EXPECT_ERROR(UsageError, "no folder of templates", description.read());
}

TEST(ForeignProgram, WhatIsNotInstalledIsSaidWithTheRemedy) {
  Description description;

  const auto program =
      description.read("needs = [\"sh\", \"no-such-solver\"]\ninstall = \"apt install it\"\n");

  EXPECT_ERROR(SystemError, "no-such-solver is not installed in P, v1; apt install it; its runs wait",
               expect_installed(program));
}

}  // namespace
}  // namespace elrom::masters
