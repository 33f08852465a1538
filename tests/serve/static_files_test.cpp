#include "static_files.hpp"

#include <gmock/gmock.h>

#include "support/temporary_folder.hpp"

namespace elrom::serve {
namespace {

using ::testing::HasSubstr;

std::optional<http::Response> get(const test::TemporaryFolder& folder, const std::string& target,
                                  const std::string& tag = "") {
  const auto parsed = http::parse_target(target);
  const http::Request request{.method = "GET", .target = target, .headers = {{"If-None-Match", tag}}};
  return parsed ? static_file(folder / "page", *parsed, request) : std::nullopt;
}

TEST(StaticFiles, AreSentWithTheirTypeAndAStrictPolicy) {
  const test::TemporaryFolder folder;
  folder.write("page/index.html", "<p>");
  folder.write("page/code/a.js", "1");

  EXPECT_EQ(get(folder, "/")->body, "<p>");
  EXPECT_EQ(*get(folder, "/")->header("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(*get(folder, "/code/a.js")->header("Content-Type"), "text/javascript; charset=utf-8");
  const auto policy = *get(folder, "/")->header("Content-Security-Policy");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, ::testing::Not(HasSubstr("unsafe")));
}

TEST(StaticFiles, AreNotSentAgainUntilTheyChange) {
  const test::TemporaryFolder folder;
  folder.write("page/a.js", "1");
  const auto tag = *get(folder, "/a.js")->header("ETag");

  const auto again = get(folder, "/a.js", tag);
  EXPECT_EQ(again->status, 304);
  EXPECT_EQ(again->body, "");
  EXPECT_EQ(*again->header("ETag"), tag);

  folder.write("page/a.js", "22");
  EXPECT_EQ(get(folder, "/a.js", tag)->status, 200);
  EXPECT_EQ(get(folder, "/a.js", tag)->body, "22");
}

TEST(StaticFiles, NothingOutsideTheFolderIsSent) {
  const test::TemporaryFolder folder;
  folder.write("secret.txt", "x");
  folder.write("page/.hidden", "x");
  folder.write("page/a/b.txt", "x");
  std::filesystem::create_symlink(folder / "secret.txt", folder / "page/link.txt");
  std::filesystem::create_symlink(folder.path(), folder / "page/up");

  for (const char* target : {"/../secret.txt", "/%2e%2e/secret.txt", "/link.txt", "/up/secret.txt",
                             "/.hidden", "/a", "/nothing", "/a/b.txt/c", "//etc/passwd"})
    EXPECT_FALSE(get(folder, target)) << target;
  EXPECT_TRUE(get(folder, "/a/b.txt"));
}

}  // namespace
}  // namespace elrom::serve
