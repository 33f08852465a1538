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
  double lease_s = 60;
  std::vector<std::string> then;

  Employed() {
    served.call("POST", "/scenarios", Served::scenario("a"));
    served.call("POST", "/runs", R"({"scenario": 1, "model": "elrom"})");
  }
  Master master(Master::Work work) {
    return {{.url = served.url(),
             .token = served.tokens["model"],
             .model = "elrom",
             .worker = "w",
             .lease_s = lease_s,
             .longest_wait_s = 0.2,
             .then = then},
            std::move(work),
            silent_log()};
  }
  Json run(int id = 1) { return json_of(served.call("GET", "/runs/" + std::to_string(id))); }
  Json result(int id = 1) { return json_of(served.call("GET", "/results/" + std::to_string(id))); }
};

Finished nothing(const Claimed&, const std::stop_token&) { return {.version = "1"}; }

TEST(Master, PredictsARunAndGivesItBackWithItsFields) {
  Employed employed;
  auto master = employed.master(
      prediction_work(employed.served.service->model(), {.folder = employed.served.folder.path()}));

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));
  EXPECT_FALSE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "done");
  const auto result = json_of(employed.served.call("GET", "/scenarios/1/results"))["items"][0];
  EXPECT_EQ(result["verdict"], "inside");
  EXPECT_EQ(result["version"], employed.served.service->model().now()->bundle().digest());
  EXPECT_EQ(employed.served.call("GET", "/fields/" + result["fields"].get<std::string>()).status, 200);
}

TEST(Master, OutsideOfWhatWasTrainedAnotherModelIsAskedFor) {
  Employed employed;
  auto far = Json::parse(Served::scenario("a"));
  far["name"] = "far";
  for (auto& value : far["inputs"]) value = 10 * value.get<double>();
  employed.served.call("POST", "/scenarios", far.dump());
  employed.served.call("POST", "/runs", R"({"scenario": 2, "model": "elrom"})");
  auto master = employed.master(prediction_work(
      employed.served.service->model(), {.folder = employed.served.folder.path(), .outside = {"el3d"}}));

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));
  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.result(1)["followed_by"], Json::array());
  EXPECT_EQ(employed.result(2)["verdict"], "outside");
  EXPECT_TRUE(employed.result(2)["fields"].is_null());
  EXPECT_THAT(employed.result(2)["reason"].get<std::string>(), HasSubstr("a run of el3d is asked for"));
  EXPECT_EQ(employed.result(2)["followed_by"], Json::array({3}));
  EXPECT_EQ(employed.run(3)["model"], "el3d");
  EXPECT_EQ(employed.run(3)["state"], "waiting");
}

TEST(Master, ModelsAreAskedOneAfterTheOtherAndGetWhatCameBefore) {
  Employed employed;
  employed.then = {"next"};
  auto first = employed.master(
      prediction_work(employed.served.service->model(), {.folder = employed.served.folder.path()}));
  Claimed seen;
  Master second(
      {.url = employed.served.url(), .token = employed.served.tokens["model"], .model = "next"},
      [&](const Claimed& claimed, const std::stop_token&) {
        seen = claimed;
        return Finished{.version = "1"};
      },
      silent_log());

  EXPECT_TRUE(first.work_once(employed.stop.get_token()));
  EXPECT_TRUE(second.work_once(employed.stop.get_token()));

  ASSERT_EQ(seen.sources.size(), 1U);
  EXPECT_EQ(seen.sources[0].model, "elrom");
  EXPECT_THAT(seen.sources[0].fields, ::testing::StartsWith("\x89HDF"));
  EXPECT_EQ(seen.load, 0.64);
  EXPECT_EQ(seen.inputs_digest, employed.run()["inputs_digest"]);
}

TEST(Master, ALeaseIsRenewedWhileTheModelWorks) {
  Employed employed;
  employed.lease_s = 1;
  std::atomic<int> n_taken_away = 0;
  auto other = employed.master(nothing);
  auto master = employed.master([&](const Claimed&, const std::stop_token&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    n_taken_away += other.work_once(employed.stop.get_token());
    return Finished{.version = "slow"};
  });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(n_taken_away, 0);
  EXPECT_EQ(employed.run()["attempts"], 1);
  EXPECT_EQ(employed.result()["version"], "slow");
}

TEST(Master, WhoLosesTheLeaseStopsAndGivesNothingBack) {
  Employed employed;
  employed.lease_s = 1;
  auto master = employed.master([&](const Claimed& claimed, const std::stop_token& stop) -> Finished {
    employed.served.call(
        "POST", "/runs/1/outcome",  // as if it had come back and gone to another
        Json{{"lease", claimed.lease}, {"state", "failed"}, {"reason", "by another"}}.dump());
    while (!stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    throw Interrupted("stopped");
  });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["reason"], "by another");
}

TEST(Master, WhoIsStoppedGivesTheRunBackAtOnce) {
  Employed employed;
  auto master = employed.master([&](const Claimed&, const std::stop_token& stop) -> Finished {
    employed.stop.request_stop();
    EXPECT_TRUE(stop.stop_requested());
    throw Interrupted("stopped");
  });

  EXPECT_THROW(master.work_once(employed.stop.get_token()), Interrupted);

  EXPECT_EQ(employed.run()["state"], "waiting");
  EXPECT_EQ(employed.run()["reason"], "its master was stopped");
}

TEST(Master, AWrongResultIsPutAside) {
  Employed employed;
  auto master = employed.master(
      [](const Claimed&, const std::stop_token&) -> Finished { throw WrongResultError("a reversed flow"); });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "quarantined");
  EXPECT_EQ(employed.run()["reason"], "a reversed flow");
}

TEST(Master, WhatAModelCannotDoFailsWithTheReason) {
  Employed employed;
  auto master = employed.master(
      [](const Claimed&, const std::stop_token&) -> Finished { throw NumericalError("it diverged"); });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "failed");
  EXPECT_EQ(employed.run()["reason"], "it diverged");
}

TEST(Master, TroubleOfTheMachineIsTriedAgainLater) {
  Employed employed;
  auto master = employed.master(
      [](const Claimed&, const std::stop_token&) -> Finished { throw SystemError("no licence"); });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "waiting");
  EXPECT_GT(employed.run()["not_before"].get<double>(), employed.run()["at"].get<double>());
}

TEST(Master, ACorruptResultIsStopped) {
  Employed employed;
  auto master = employed.master(
      [](const Claimed&, const std::stop_token&) { return Finished{.version = "1", .fields = "no HDF5"}; });

  EXPECT_TRUE(master.work_once(employed.stop.get_token()));

  EXPECT_EQ(employed.run()["state"], "quarantined");
  EXPECT_THAT(employed.run()["reason"].get<std::string>(), HasSubstr("refuses the fields"));
  EXPECT_EQ(json_of(employed.served.call("GET", "/quarantine"))["items"].size(), 1U);
}

TEST(Master, WaitsForARepositoryThatIsAwayUntilItIsStopped) {
  std::stop_source stop;
  Master master(
      {.url = "http://127.0.0.1:1", .model = "elrom", .longest_wait_s = 0.1},
      [](const Claimed&, const std::stop_token&) { return Finished{}; }, silent_log());
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
      [](const Claimed&, const std::stop_token&) { return Finished{}; }, silent_log());

  EXPECT_ERROR(InputError, "role does not allow it", master.work_once(employed.stop.get_token()));
}

}  // namespace
}  // namespace elrom::serve
