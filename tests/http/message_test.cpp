#include "elrom/http/message.hpp"

#include <gmock/gmock.h>

namespace elrom::http {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

TEST(Target, IsTakenApartAndDecoded) {
  const auto target = parse_target("/scenarios/a%20b%2Bc?state=waiting&name=x+y%26z&flag");

  ASSERT_TRUE(target);
  EXPECT_THAT(target->segments, ElementsAre("scenarios", "a b+c"));
  EXPECT_THAT(target->query, ElementsAre(Pair("state", "waiting"), Pair("name", "x y&z"), Pair("flag", "")));
  EXPECT_EQ(target->value("name"), "x y&z");
  EXPECT_EQ(target->value("other"), std::nullopt);
}

TEST(Target, ACodeMayEndItAndHasDigitsOfEitherCase) {
  EXPECT_THAT(parse_target("/a%2b")->segments, ElementsAre("a+"));
  EXPECT_THAT(parse_target("/a%2B")->segments, ElementsAre("a+"));
  EXPECT_THAT(parse_target("/%C3%9f")->segments, ElementsAre("\xC3\x9F"));
  EXPECT_FALSE(parse_target("/%fA%00x"));
}

TEST(Target, TheRootHasNoSegments) {
  EXPECT_THAT(parse_target("/")->segments, IsEmpty());
  EXPECT_THAT(parse_target("/?a=1")->segments, IsEmpty());
}

TEST(Target, WhatLeavesAFolderOrIsBrokenIsRefused) {
  for (const char* target : {"",    "a",     "*",      "http://host/", "/..",    "/a/../b", "/a/%2e%2e/b",
                             "/.",  "/a//b", "//etc",  "/a%2Fb",       "/a%5cb", "/a\\b",   "/%",
                             "/%4", "/%zz",  "/a%00b", "/a%0ab",       "/?a=%",  "/?%0d=1", "/a\x01"})
    EXPECT_FALSE(parse_target(target)) << target;
}

TEST(Tags, AreFoundAmongThoseThatTheCallerHas) {
  const auto has = [](const char* header) {
    return has_tag({.method = "GET", .target = "/", .headers = {{"If-None-Match", header}}}, "\"a\"");
  };

  for (const char* header : {"\"a\"", "W/\"a\"", "\"b\", \"a\"", "\"b\",W/\"a\" ", "*"})
    EXPECT_TRUE(has(header)) << header;
  for (const char* header : {"", "a", "\"b\"", "\"A\"", "\"ab\""}) EXPECT_FALSE(has(header)) << header;
  EXPECT_FALSE(has_tag({.method = "GET", .target = "/"}, "\"a\""));
}

TEST(Headers, AreFoundWhateverTheirCapitals) {
  const Headers headers{{"Content-Type", "text/plain"}, {"ETag", "1"}, {"etag", "2"}, {"aZ", "3"}};

  ASSERT_NE(find_header(headers, "content-type"), nullptr);
  EXPECT_EQ(*find_header(headers, "CONTENT-TYPE"), "text/plain");
  EXPECT_EQ(*find_header(headers, "etag"), "1");
  EXPECT_EQ(*find_header(headers, "Az"), "3");
  EXPECT_EQ(find_header(headers, "content"), nullptr);
}

}  // namespace
}  // namespace elrom::http
