#include "elrom/repository/transaction.hpp"

#include "backends.hpp"
#include "support/throws.hpp"

namespace elrom::repository {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class TransactionOn : public EachDatabase {
 protected:
  /// What a piece of work in one transaction returns.
  template <class Work>
  auto write(const Work& work) {
    decltype(work(std::declval<Transaction&>())) result{};
    repository().write([&](Transaction& transaction) { result = work(transaction); });
    return result;
  }
  Scenario scenario(const std::string& name) {
    return write([&](Transaction& t) { return t.add(sample_scenario(name)); });
  }
  ModelRun waiting_run(Id scenario, const std::string& model = "elrom") {
    return write([&](Transaction& t) { return t.add_run(scenario, model, {}, "tester"); });
  }
  std::optional<ModelRun> claim(const std::string& worker, double lease_s = 60,
                                const std::string& model = "elrom") {
    return write([&](Transaction& t) { return t.claim(model, worker, lease_s); });
  }
  ModelRun give_back(const ModelRun& run, const Outcome& outcome) {
    return write([&](Transaction& t) { return t.give_back(run.id, run.lease, outcome); });
  }
};

TEST_P(TransactionOn, AScenarioReadsBackAsItWasTold) {
  const auto id = scenario("a").id;
  close();

  const auto read = write([&](Transaction& t) { return t.scenario(id); });

  const auto told = sample_scenario("a");
  EXPECT_EQ(read.name, told.name);
  EXPECT_EQ(read.note, told.note);
  EXPECT_EQ(read.load, told.load);
  EXPECT_EQ(read.inputs, told.inputs);
  EXPECT_EQ(read.verdict, told.verdict);
  EXPECT_EQ(read.reason, told.reason);
  EXPECT_EQ(read.by, told.by);
  EXPECT_EQ(read.revision, 1);
  EXPECT_EQ(read.at, now_);
}

TEST_P(TransactionOn, ANameIsTakenOnce) {
  scenario("a");

  EXPECT_ERROR(ConflictError, "of that name is there already: found 'a'", scenario("a"));
}

TEST_P(TransactionOn, AChangeNeedsTheRevisionThatWasRead) {
  auto first = scenario("a");
  scenario("b");
  first.note = "changed";

  const auto changed = write([&](Transaction& t) { return t.change(first, 1); });

  EXPECT_EQ(changed.revision, 2);
  EXPECT_EQ(changed.note, "changed");
  EXPECT_ERROR(StaleError, "found revision 1, expected 2",
               write([&](Transaction& t) { return t.change(first, 1); }));
  first.name = "b";
  EXPECT_ERROR(ConflictError, "found 'b'", write([&](Transaction& t) { return t.change(first, 2); }));
}

TEST_P(TransactionOn, ListsComeInParts) {
  for (const char* name : {"a", "b", "c", "d", "e"}) scenario(name);

  const auto names = [&](const ListPart& part) {
    std::vector<std::string> all;
    for (const auto& one : write([&](Transaction& t) { return t.scenarios(part); })) all.push_back(one.name);
    return all;
  };

  EXPECT_THAT(names({.n = 2}), ElementsAre("a", "b"));
  EXPECT_THAT(names({.after = 2, .n = 2}), ElementsAre("c", "d"));
  EXPECT_THAT(names({.after = 5}), IsEmpty());
}

TEST_P(TransactionOn, ARunKeepsTheInputsItWasMadeFor) {
  auto first = scenario("a");
  const auto run = waiting_run(first.id);
  first.inputs = R"({"primary_air [kg/s]":200.0})";
  write([&](Transaction& t) { return t.change(first, 1); });

  const auto inputs = write([&](Transaction& t) { return t.inputs(t.run(run.id).inputs_digest); });

  EXPECT_EQ(inputs, sample_scenario("a").inputs);
}

TEST_P(TransactionOn, RunsAreGivenOutInOrderAndOnce) {
  const auto id = scenario("a").id;
  const auto first = waiting_run(id), second = waiting_run(id);
  waiting_run(id, "other");

  EXPECT_EQ(claim("x")->id, first.id);
  EXPECT_EQ(claim("y")->id, second.id);
  EXPECT_EQ(claim("z"), std::nullopt);
}

TEST_P(TransactionOn, ADeadMastersRunReturnsWhenItsLeaseEnds) {
  const auto id = waiting_run(scenario("a").id).id;
  const auto dead = *claim("dead", 60);

  now_ += 59;
  EXPECT_EQ(claim("next"), std::nullopt);
  now_ += 2;
  const auto again = claim("next");

  ASSERT_TRUE(again);
  EXPECT_EQ(again->id, id);
  EXPECT_EQ(again->attempts, 2);
  EXPECT_NE(again->lease, dead.lease);
  EXPECT_ERROR(ConflictError, "the run is not yours", give_back(dead, {.state = RunState::done}));
  EXPECT_ERROR(ConflictError, "the run is not yours",
               write([&](Transaction& t) { return t.renew(id, dead.lease, 60); }));
}

TEST_P(TransactionOn, ARenewedLeaseHolds) {
  waiting_run(scenario("a").id);
  const auto run = *claim("x", 60);
  now_ += 50;
  write([&](Transaction& t) { return t.renew(run.id, run.lease, 60); });
  now_ += 50;

  EXPECT_EQ(claim("y"), std::nullopt);
  EXPECT_EQ(give_back(run, {.state = RunState::done}).state, RunState::done);
}

TEST_P(TransactionOn, ARunThatKillsItsMastersIsQuarantined) {
  const auto id = waiting_run(scenario("a").id).id;
  for (int i = 0; i < Transaction::most_attempts; ++i) {
    ASSERT_TRUE(claim("m" + std::to_string(i), 10)) << i;
    now_ += 11;
  }

  EXPECT_EQ(claim("last"), std::nullopt);

  const auto run = write([&](Transaction& t) { return t.run(id); });
  EXPECT_EQ(run.state, RunState::quarantined);
  EXPECT_THAT(run.reason, HasSubstr("none came back; last m4"));
}

TEST_P(TransactionOn, AFailureIsTriedAgainLaterAndNotForEver) {
  const auto id = waiting_run(scenario("a").id).id;
  for (int i = 0; i < Transaction::most_attempts; ++i) {
    const auto run = claim("x");
    ASSERT_TRUE(run) << i;
    give_back(*run, {.state = RunState::waiting, .reason = "no licence", .retry_after_s = 30});
    EXPECT_EQ(claim("x"), std::nullopt);
    now_ += 31;
  }

  EXPECT_EQ(claim("x"), std::nullopt);
  const auto run = write([&](Transaction& t) { return t.run(id); });
  EXPECT_EQ(run.state, RunState::failed);
  EXPECT_EQ(run.reason, "no licence");
}

TEST_P(TransactionOn, AResultNamesModelInputsAndSources) {
  const auto of = scenario("a");
  waiting_run(of.id);
  const std::string fields(64, 'a');
  write([&](Transaction& t) { return t.know({.digest = fields, .bytes = 3, .by = "x"}), 0; });
  const auto run = *claim("x");
  give_back(
      run,
      {.result = {.version = "v1", .verdict = "edge", .reason = "far", .document = "{}", .fields = fields}});

  const auto result = write([&](Transaction& t) { return t.result_of(run.id); });
  const auto next = write([&](Transaction& t) { return t.add_run(of.id, "sfw3d", {result.id}, "x"); });

  EXPECT_EQ(result.model, "elrom");
  EXPECT_EQ(result.version, "v1");
  EXPECT_EQ(result.verdict, "edge");
  EXPECT_EQ(result.fields, fields);
  EXPECT_EQ(result.inputs_digest, of.inputs_digest);
  EXPECT_THAT(write([&](Transaction& t) { return t.run(next.id); }).sources, ElementsAre(result.id));
  EXPECT_EQ(write([&](Transaction& t) { return t.results(of.id, {}); }).size(), 1U);
}

TEST_P(TransactionOn, AnOutcomeAsksForTheNextModelsWorkOnTheSameInputs) {
  const auto of = scenario("a");
  const auto run = waiting_run(of.id);
  (void)claim("x");
  write([&](Transaction& t) {  // a change since then is another matter
    auto changed = t.scenario(of.id);
    changed.inputs = R"({"primary_air [kg/s]":99.0})";
    return t.change(changed, 1);
  });

  give_back(write([&](Transaction& t) { return t.run(run.id); }),
            {.result = {.version = "v1", .verdict = "outside"}, .ask = {"el3d"}});

  const auto result = write([&](Transaction& t) { return t.result_of(run.id); });
  ASSERT_EQ(result.followed_by.size(), 1U);
  const auto asked = write([&](Transaction& t) { return t.run(result.followed_by[0]); });
  EXPECT_EQ(asked.model, "el3d");
  EXPECT_EQ(asked.state, RunState::waiting);
  EXPECT_EQ(asked.inputs_digest, of.inputs_digest);
  EXPECT_THAT(asked.sources, ElementsAre(result.id));
}

TEST_P(TransactionOn, TheSameInputsAreAskedForOnceAndAgainAfterAFailure) {
  const auto of = scenario("a");
  const auto ask = [&] {
    waiting_run(of.id);
    const auto run = *claim("x");
    give_back(run, {.result = {.version = "v1"}, .ask = {"el3d"}});
    return write([&](Transaction& t) { return t.result_of(run.id); }).followed_by;
  };
  const auto first = ask(), second = ask();
  give_back(*claim("x", 60, "el3d"), {.state = RunState::failed, .reason = "it diverged"});
  const auto third = ask();

  EXPECT_EQ(first, second);
  EXPECT_NE(first, third);
  EXPECT_EQ(write([&](Transaction& t) { return t.run(first[0]); }).sources.size(), 2U);
}

TEST_P(TransactionOn, AResultWithoutItsFieldsIsRefusedWhole) {
  waiting_run(scenario("a").id);
  const auto run = *claim("x");

  EXPECT_ERROR(InputError, "fields that are not here",
               give_back(run, {.result = {.version = "v1", .fields = std::string(64, 'b')}}));

  EXPECT_EQ(write([&](Transaction& t) { return t.run(run.id); }).state, RunState::running);
}

TEST_P(TransactionOn, RunsAreFoundByStateModelAndScenario) {
  const auto a = scenario("a").id, b = scenario("b").id;
  waiting_run(a);
  waiting_run(b);
  waiting_run(b, "sfw3d");
  (void)claim("x");

  const auto count = [&](const RunFilter& filter) {
    return write([&](Transaction& t) { return t.runs(filter, {}); }).size();
  };

  EXPECT_EQ(count({}), 3U);
  EXPECT_EQ(count({.state = RunState::waiting}), 2U);
  EXPECT_EQ(count({.model = "elrom"}), 2U);
  EXPECT_EQ(count({.scenario = b}), 2U);
  EXPECT_EQ(count({.model = "elrom", .state = RunState::waiting, .scenario = a}), 0U);
}

TEST_P(TransactionOn, QuarantineKeepsDocumentAndReason) {
  const auto id = write([](Transaction& t) {
                    return t.quarantine(
                        {.kind = "scenario", .document = "{\"x\":-1}", .reason = "impossible", .by = "y"});
                  }).id;

  const auto kept = write([&](Transaction& t) { return t.quarantined(id); });

  EXPECT_EQ(kept.document, "{\"x\":-1}");
  EXPECT_EQ(kept.reason, "impossible");
  EXPECT_EQ(write([](Transaction& t) { return t.quarantine_list({}); }).size(), 1U);
  EXPECT_ERROR(NotFoundError, "no quarantined record 7",
               write([](Transaction& t) { return t.quarantined(7); }));
}

TEST_P(TransactionOn, ATokenIsKnownByItsSecretAlone) {
  const auto secret = write([](Transaction& t) { return t.make_token("master-1", Role::model); });
  const auto of = [&](const std::string& text) {
    return write([&](Transaction& t) { return t.token_of(text); });
  };

  ASSERT_TRUE(of(secret));
  EXPECT_EQ(of(secret)->name, "master-1");
  EXPECT_EQ(of(secret)->role, Role::model);
  auto other = secret;
  other.back() = other.back() == '0' ? '1' : '0';
  for (const std::string& wrong :
       {other, secret.substr(0, secret.size() - 1), secret + "0", std::string("elrom.master-1."),
        std::string("elrom.other.") + secret.substr(15), std::string(), std::string("..."),
        std::string("elrom.\xFF.x")})
    EXPECT_FALSE(of(wrong)) << wrong;
  EXPECT_ERROR(ConflictError, "of that name is there",
               write([](Transaction& t) { return t.make_token("master-1", Role::reader); }));
  EXPECT_ERROR(UsageError, "no name for a token",
               write([](Transaction& t) { return t.make_token("a.b", Role::reader); }));

  write([](Transaction& t) { return t.remove_token("master-1"), 0; });

  EXPECT_FALSE(of(secret));
  EXPECT_ERROR(NotFoundError, "no token 'master-1'",
               write([](Transaction& t) { return t.remove_token("master-1"), 0; }));
}

TEST_P(TransactionOn, CountsSayWhatIsThere) {
  const auto id = scenario("a").id;
  waiting_run(id);
  waiting_run(id);
  (void)claim("x");

  const auto counts = write([](Transaction& t) { return t.counts(); });

  EXPECT_EQ(counts.at("scenarios"), 1);
  EXPECT_EQ(counts.at("runs_waiting"), 1);
  EXPECT_EQ(counts.at("runs_running"), 1);
  EXPECT_EQ(counts.at("runs_failed"), 0);
  EXPECT_EQ(counts.at("quarantine"), 0);
}

ELROM_ON_EACH_DATABASE(TransactionOn);

}  // namespace
}  // namespace elrom::repository
