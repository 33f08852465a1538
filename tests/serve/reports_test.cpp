#include "reports.hpp"

#include "served.hpp"

namespace elrom::serve {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Places, AreOpenForATimeToWhoKnowsTheSecret) {
  Places places(std::chrono::minutes(1));
  const auto a = places.open("/a.html"), b = places.open("/b.html");

  EXPECT_EQ(places.file(a), "/a.html");
  EXPECT_EQ(places.file(b), "/b.html");
  EXPECT_EQ(places.file(a.substr(1)), std::nullopt);
  EXPECT_EQ(places.file(""), std::nullopt);
}

TEST(Places, CloseByThemselves) {
  Places places(std::chrono::seconds(-1));
  EXPECT_EQ(places.file(places.open("/a.html")), std::nullopt);
}

/// What elrom-report does to the server: a page about what it was asked for.
void have_reports(const Served& served,
                  const std::string& script =
                      "while [ $1 != --html ]; do words=\"$words $1\"; shift; done\n"
                      "echo \"<script>'$words'</script><script type='x'>\" >$2\nexit 7\n") {
  const auto program = served.folder.write("report", "#!/bin/sh\n" + script);
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
}

TEST(Reports, AreMadeOnceAndOpenWithoutAToken) {
  Served served;
  have_reports(served);

  const auto made = served.call("POST", "/models/1/report");
  const auto opened = served.send({.method = "GET", .target = json_of(made)["place"]});
  have_reports(served, "exit 1\n");
  const auto again = served.call("POST", "/models/1/report");

  EXPECT_EQ(made.status, 201);
  EXPECT_EQ(*made.header("Location"), json_of(made)["place"]);
  EXPECT_EQ(*opened.header("Content-Type"), "text/html; charset=utf-8");
  EXPECT_THAT(opened.body, HasSubstr(" accuracy " + served.folder.path().string() + "'</script>"));
  EXPECT_EQ(again.status, 201);
  EXPECT_NE(json_of(again)["place"], json_of(made)["place"]);
  EXPECT_EQ(served.send({.method = "GET", .target = "/reports/" + std::string(64, 'a')}).status, 404);
}

TEST(Reports, OfAVersionThatDoesNotAnswerCompare) {
  Served served;
  have_reports(served);
  test::sample_bundle({}, 2).write(served.folder / "models/2.elrom");

  const auto place = json_of(served.call("POST", "/models/2/report"))["place"];

  EXPECT_THAT(served.send({.method = "GET", .target = place}).body,
              HasSubstr(" compare " + served.folder.path().string() + " " + served.folder.path().string() +
                        "/models/2.elrom'"));
}

TEST(Reports, RunTheirScriptsInASandboxAndReachNothing) {
  Served served;
  have_reports(served);
  const http::Request request{.method = "GET",
                              .target = json_of(served.call("POST", "/models/1/report"))["place"]};

  const auto opened = served.send(request);
  const auto policy = *opened.header("Content-Security-Policy");
  const auto begin = opened.body.find("<script nonce=\"") + 15;
  const auto nonce = opened.body.substr(begin, 64);

  EXPECT_THAT(policy,
              HasSubstr("sandbox allow-scripts; default-src 'none'; script-src 'nonce-" + nonce + "';"));
  EXPECT_THAT(policy, Not(HasSubstr("allow-same-origin")));
  EXPECT_THAT(policy, Not(HasSubstr("connect-src")));
  EXPECT_THAT(opened.body, HasSubstr("<script type='x'>"));
  EXPECT_THAT(served.send(request).body, Not(HasSubstr(nonce)));
}

TEST(Reports, SayWhyThereAreNone) {
  Served served;
  have_reports(served, "echo 'elrom-report: error: no store' >&2; exit 3\n");
  const auto failed = served.call("POST", "/models/1/report");
  EXPECT_EQ(failed.status, 422);
  EXPECT_EQ(json_of(failed)["found"], "no store");

  const test::TemporaryFolder folder;
  test::sample_bundle({}).write(folder / "model.elrom");
  study::Versions versions(folder.path());
  versions.settle();
  EXPECT_THROW((void)Reports(folder / "reports", "").of(folder.path(), versions, 1),
               repository::NotFoundError);
}

}  // namespace
}  // namespace elrom::serve
