#include "json_body.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::serve {
namespace {

using ::testing::ElementsAre;

TEST(JsonBody, GivesValuesOfTheirTypes) {
  const JsonBody body(R"({"t": "x", "n": 1.5, "w": 3, "f": true, "l": ["a", "b"], "o": {"i": [1, 2]}})",
                      {"t", "n", "w", "f", "l", "o"});

  EXPECT_EQ(body.text("t"), "x");
  EXPECT_EQ(body.number("n"), 1.5);
  EXPECT_EQ(body.whole("w"), 3);
  EXPECT_TRUE(body.flag_or("f", false));
  EXPECT_THAT(body.texts("l"), ElementsAre("a", "b"));
  EXPECT_THAT(body.object("o", {"i"}).wholes("i"), ElementsAre(1, 2));
  EXPECT_EQ(body.text_or("missing", "y"), "y");
  EXPECT_TRUE(body.texts("missing").empty());
}

TEST(JsonBody, SaysWhatIsMissingOrOfAnotherType) {
  const JsonBody body(R"({"t": 1, "n": "x", "w": 1.5, "l": [1]})", {"t", "n", "w", "l", "o"});

  EXPECT_ERROR(InputError, "wrong type of 't' in request: found number, expected a text", body.text("t"));
  EXPECT_ERROR(InputError, "wrong type of 'n'", body.number("n"));
  EXPECT_ERROR(InputError, "expected a whole number", body.whole("w"));
  EXPECT_ERROR(InputError, "expected a list of texts", body.texts("l"));
  EXPECT_ERROR(InputError, "missing 'o' in request: expected an object", body.object("o", {}));
}

TEST(JsonBody, AnUnknownOrRepeatedKeyIsRefused) {
  EXPECT_ERROR(InputError, "unknown key 'nmae' in request; did you mean 'name'?",
               JsonBody(R"({"nmae": 1})", {"name"}));
  EXPECT_ERROR(InputError, "a key appears twice: found 'a'", JsonBody(R"({"a": 1, "a": 2})", {"a"}));
  EXPECT_ERROR(InputError, "unknown key 'x' in request, o",
               JsonBody(R"({"o": {"x": 1}})", {"o"}).object("o", {"y"}));
}

TEST(JsonBody, WhatIsNoJsonIsTheCallersMistake) {
  for (const char* text : {"", "{", "{\"a\": }", "nul", "{} {}", "{\"a\": \"\xFF\"}", "[1,]"})
    EXPECT_THROW(JsonBody(text, {"a"}), UsageError) << text;
  EXPECT_ERROR(InputError, "no object in request: found array", JsonBody("[]", {}));
  EXPECT_ERROR(InputError, "a key is too long", JsonBody("{\"" + std::string(201, 'a') + "\": 1}", {}));
  EXPECT_ERROR(InputError, "NUL", JsonBody(R"({"a": "x\u0000y"})", {"a"}));
  EXPECT_ERROR(UsageError, "nested too deeply",
               JsonBody("{\"a\":" + std::string(40, '[') + std::string(40, ']') + "}", {"a"}));
}

}  // namespace
}  // namespace elrom::serve
