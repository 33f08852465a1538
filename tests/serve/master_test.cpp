#include "elrom/serve/master.hpp"

#include <thread>

#include "served.hpp"
#include "support/throws.hpp"

namespace elrom::serve {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

/// A served repository with one run that waits, and a master for it.
struct Employed {
  Served served;
  std::stop_source stop;

  Employed() {
    served.call("POST", "/scenarios", Served::scenario("a"));
    served.call("POST", "/runs", R"({"scenario": 1, "model": "elrom"})");
  }
  Master master(Master::Work work) {
    return {{.url = served.url(),
             .token = served.tokens["model"],
             .model = "elrom",
             .worker = "w",
             .longest_wait_s = 0.2},
            std::move(work),
            silent_log()};
  }
  Json run() { return json_of(served.call("GET", "/runs/1")); }
};

TEST(Master, PredictsARunAndGivesItBackWithItsFields) {
  Employed employed;
  auto master =
      employed.master(prediction_work(employed.served.service->model(), employed.served.folder.path()));

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));
  EXPECT_FALSE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "done");
  const auto result = json_of(employed.served.call("GET", "/scenarios/1/results"))["items"][0];
  EXPECT_EQ(result["verdict"], "inside");
  EXPECT_EQ(result["version"], employed.served.service->model().now()->bundle().digest());
  EXPECT_EQ(employed.served.call("GET", "/fields/" + result["fields"].get<std::string>()).status, 200);
}

TEST(Master, WhatAModelCannotDoFailsWithTheReason) {
  Employed employed;
  auto master = employed.master([](const Claimed&) -> Finished { throw NumericalError("it diverged"); });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "failed");
  EXPECT_EQ(employed.run()["reason"], "it diverged");
}

TEST(Master, TroubleOfTheMachineIsTriedAgainLater) {
  Employed employed;
  auto master = employed.master([](const Claimed&) -> Finished { throw SystemError("no licence"); });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "waiting");
  EXPECT_GT(employed.run()["not_before"].get<double>(), employed.run()["at"].get<double>());
}

TEST(Master, ACorruptResultIsStopped) {
  Employed employed;
  auto master = employed.master([](const Claimed&) { return Finished{.version = "1", .fields = "no HDF5"}; });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "failed");
  EXPECT_THAT(employed.run()["reason"].get<std::string>(), HasSubstr("refuses the fields"));
  EXPECT_EQ(json_of(employed.served.call("GET", "/quarantine"))["items"].size(), 1U);
}

TEST(Master, WaitsForARepositoryThatIsAwayUntilItIsStopped) {
  std::stop_source stop;
  Master master(
      {.url = "http://127.0.0.1:1", .model = "elrom", .longest_wait_s = 0.1},
      [](const Claimed&) { return Finished{}; }, silent_log());
  std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    stop.request_stop();
  });

  EXPECT_ERROR(Interrupted, "while the repository was away", master.work_once(stop.get_token()));
}

TEST(Master, ATokenThatMayNotIsToldAtOnce) {
  Employed employed;
  Master master(
      {.url = employed.served.url(), .token = employed.served.tokens["reader"], .model = "elrom"},
      [](const Claimed&) { return Finished{}; }, silent_log());

  EXPECT_ERROR(InputError, "role does not allow it", master.work_once(employed.stop.get_token()));
}

}  // namespace
}  // namespace elrom::serve
