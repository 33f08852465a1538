#include "elrom/repository/repository.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <map>
#include <mutex>
#include <set>
#include <thread>

#include "backends.hpp"
#include "database.hpp"
#include "elrom/base/random.hpp"
#include "schema.hpp"
#include "support/throws.hpp"
#include "transact.hpp"

namespace elrom::repository {
namespace {

class RepositoryOn : public EachDatabase {};

/// A write that makes the scenario `name`.
Answer add_once(Repository& repository, const std::string& key, const std::string& name) {
  return repository.once({.key = key, .digest = "add " + name}, [&](Transaction& transaction) {
    const auto made = transaction.add(sample_scenario(name));
    return Answer{.status = 201, .body = std::to_string(made.id), .tag = "1", .place = "/scenarios"};
  });
}

std::map<std::string, int> scenarios_by_name(Repository& repository) {
  std::map<std::string, int> names;
  repository.read([&](Transaction& transaction) {
    names.clear();
    for (const auto& one : transaction.scenarios({.n = 100000})) ++names[one.name];
  });
  return names;
}

TEST_P(RepositoryOn, AWriteIsDoneOnceAndAnsweredAlike) {
  const auto first = add_once(repository(), "k", "a");
  close();

  const auto second = add_once(repository(), "k", "a");

  EXPECT_FALSE(first.repeated);
  EXPECT_TRUE(second.repeated);
  EXPECT_EQ(second.status, 201);
  EXPECT_EQ(second.body, first.body);
  EXPECT_EQ(second.tag, "1");
  EXPECT_EQ(second.place, "/scenarios");
  EXPECT_EQ(scenarios_by_name(repository()), (std::map<std::string, int>{{"a", 1}}));
}

TEST_P(RepositoryOn, AKeyIsNotUsedForAnotherRequest) {
  add_once(repository(), "k", "a");

  EXPECT_ERROR(ConflictError, "key used before for another request: found 'k'",
               add_once(repository(), "k", "b"));

  EXPECT_EQ(scenarios_by_name(repository()).size(), 1U);
}

TEST_P(RepositoryOn, WhatFailsKeepsNothingAndMayBeTriedAgain) {
  const auto fails = [](Transaction& transaction) -> Answer {
    transaction.add(sample_scenario("a"));
    throw InputError("no");
  };

  EXPECT_ERROR(InputError, "no", repository().once({.key = "k", .digest = "add a"}, fails));

  EXPECT_TRUE(scenarios_by_name(repository()).empty());
  EXPECT_FALSE(add_once(repository(), "k", "a").repeated);
}

TEST_P(RepositoryOn, WhatDidNothingIsNotRemembered) {
  const auto nothing = [](Transaction& transaction) {
    transaction.add(sample_scenario("a"));
    return Answer{.status = 204, .kept = false};
  };

  EXPECT_EQ(repository().once({.key = "k", .digest = "d"}, nothing).status, 204);

  EXPECT_TRUE(scenarios_by_name(repository()).empty());
  EXPECT_FALSE(add_once(repository(), "k", "a").repeated);
}

TEST_P(RepositoryOn, OldAnswersAreForgotten) {
  add_once(repository(), "k", "a");
  now_ += 100;
  add_once(repository(), "l", "b");

  repository().forget_calls(now_ - 50);

  EXPECT_FALSE(add_once(repository(), "k", "c").repeated);
  EXPECT_TRUE(add_once(repository(), "l", "b").repeated);
}

/// Calls come several times, in any order, from several clients, some of them with another payload.
TEST_P(RepositoryOn, RepeatedAndReorderedCallsAreDoneOnce) {
  constexpr int n_calls = 60, n_clients = 4;
  base::Random random(base::Seed(7).derive("calls"));
  std::vector<int> sent;
  for (int call = 0; call < n_calls; ++call)
    for (auto n = 1 + random.below(4); n > 0; --n) sent.push_back(call);
  random.shuffle(sent);
  std::mutex mutex;
  std::map<int, std::set<std::string>> answers;
  std::atomic<int> n_first = 0, n_conflicts = 0;
  (void)repository();

  const auto client = [&](int number) {
    for (std::size_t i = static_cast<std::size_t>(number); i < sent.size(); i += n_clients) {
      const auto key = "key" + std::to_string(sent[i]);
      const auto answer = add_once(repository(), key, "scenario" + std::to_string(sent[i]));
      n_first += !answer.repeated;
      try {
        add_once(repository(), key, "another");
      } catch (const ConflictError&) {
        ++n_conflicts;
      }
      const std::scoped_lock lock(mutex);
      answers[sent[i]].insert(answer.body);
    }
  };
  std::vector<std::thread> clients;
  for (int i = 0; i < n_clients; ++i) clients.emplace_back(client, i);
  for (auto& thread : clients) thread.join();

  EXPECT_EQ(n_first, n_calls);
  EXPECT_EQ(n_conflicts, static_cast<int>(sent.size()));
  for (const auto& [call, different] : answers) EXPECT_EQ(different.size(), 1U) << call;
  const auto names = scenarios_by_name(repository());
  EXPECT_EQ(names.size(), static_cast<std::size_t>(n_calls));
  for (const auto& [name, n] : names) EXPECT_EQ(n, 1) << name;
}

TEST_P(RepositoryOn, NoRunIsGivenToTwoMasters) {
  constexpr int n_runs = 40, n_masters = 6;
  repository().write([](Transaction& transaction) {
    const auto id = transaction.add(sample_scenario("a")).id;
    for (int i = 0; i < n_runs; ++i) transaction.add_run(id, "elrom", {}, "x");
  });
  std::mutex mutex;
  std::vector<Id> given;

  const auto master = [&](int number) {
    for (;;) {
      std::optional<ModelRun> run;
      repository().write([&](Transaction& t) { run = t.claim("elrom", std::to_string(number), 60); });
      if (!run) return;
      const std::scoped_lock lock(mutex);
      given.push_back(run->id);
    }
  };
  std::vector<std::thread> masters;
  for (int i = 0; i < n_masters; ++i) masters.emplace_back(master, i);
  for (auto& thread : masters) thread.join();

  EXPECT_EQ(given.size(), static_cast<std::size_t>(n_runs));
  EXPECT_EQ(std::set<Id>(given.begin(), given.end()).size(), given.size());
}

/// A process that writes for ever and tells what was acknowledged.
[[noreturn]] void write_for_ever(const RepositoryOptions& options, int told, int first) {
  Repository repository(options);
  for (int i = first;; ++i) {
    add_once(repository, "key" + std::to_string(i), "scenario" + std::to_string(i));
    if (::write(told, &i, sizeof i) != sizeof i) ::_exit(1);
  }
}

/// A writer is killed a moment after so many acknowledged writes. @return the last one acknowledged; -1: none
int kill_a_writer(const RepositoryOptions& options, int first, std::uint64_t n_writes,
                  std::uint64_t microseconds) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    write_for_ever(options, ends[1], first);
  }
  ::close(ends[1]);
  int last = -1, number = 0;
  for (; n_writes > 0 && ::read(ends[0], &number, sizeof number) == sizeof number; --n_writes) last = number;
  std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  while (::read(ends[0], &number, sizeof number) == sizeof number) last = number;
  ::close(ends[0]);
  return last;
}

TEST_P(RepositoryOn, AKilledWriterLosesAndDoublesNothingThatWasAcknowledged) {
  base::Random random(base::Seed(3).derive("kills"));
  int next = 0;
  for (int kill = 0; kill < 12; ++kill) {
    const int last = kill_a_writer(options(), next, random.below(6), random.below(20000));

    const auto names = scenarios_by_name(repository());
    for (int i = 0; i <= last; ++i)
      ASSERT_EQ(names.count("scenario" + std::to_string(i)), 1U) << i << " of " << last << " is lost";
    next = std::max(next, last + 1);
    // The one that was cut off is repeated by its caller: there it is, once.
    add_once(repository(), "key" + std::to_string(next), "scenario" + std::to_string(next));
    ++next;
    ASSERT_EQ(scenarios_by_name(repository()).size(), static_cast<std::size_t>(next));
    close();
  }
  EXPECT_GT(next, 24);
}

TEST_P(RepositoryOn, AnOlderDatabaseIsBroughtUp) {
  std::filesystem::create_directories(options().folder);
  {
    const auto backend = open_backend(options().database, options().folder);
    const auto connection = backend->connect();
    bring_up(*backend, *connection, 0);  // before the first step: kind and version alone
    transact(*connection, false, [&] {
      EXPECT_THROW((void)connection->query("SELECT count(*) FROM scenarios", {}), SystemError);
    });
  }

  add_once(repository(), "k", "a");
  close();

  EXPECT_TRUE(add_once(repository(), "k", "a").repeated);
}

TEST_P(RepositoryOn, ADatabaseOfTheFirstReleaseIsBroughtUpWithAllThatIsInIt) {
  std::filesystem::create_directories(options().folder);
  {
    const auto backend = open_backend(options().database, options().folder);
    const auto connection = backend->connect();
    bring_up(*backend, *connection, 1);
    transact(*connection, true, [&] {
      for (
          const auto* row :
          {"INSERT INTO inputs VALUES ('d', '{}')",
           "INSERT INTO scenarios (revision, name, boiler, note, load, inputs, verdict, reason, by, at) "
           "VALUES (1, 'old', '', '', 0.5, 'd', '', '', 'x', 7)",
           "INSERT INTO runs (revision, scenario, inputs, model, state, worker, lease, lease_until, not_before, "
           "attempts, reason, by, at) VALUES (1, 1, 'd', 'elrom', 'done', 'w', '', 0, 0, 1, '', 'x', 7), "
           "(1, 1, 'd', 'sfw3d', 'waiting', '', '', 0, 0, 0, '', 'x', 7)",
           "INSERT INTO results (run, scenario, inputs, model, version, verdict, reason, document, fields, at) "
           "VALUES (1, 1, 'd', 'elrom', 'v1', 'inside', '', '{}', '', 7)",
           "INSERT INTO lineage VALUES (2, 1)"})
        connection->query(row, {});
    });
  }

  repository().read([&](Transaction& transaction) {
    EXPECT_EQ(transaction.scenario(1).name, "old");
    EXPECT_EQ(transaction.run(2).state, RunState::waiting);
    EXPECT_THAT(transaction.result(1).followed_by, ::testing::ElementsAre(2));
  });
  close();

  const auto backend = open_backend(options().database, options().folder);
  const auto connection = backend->connect();  // outlives its rows
  const auto row = connection->query("SELECT value FROM about WHERE key = 'format_minor'", {});
  ASSERT_TRUE(row->next());
  EXPECT_EQ(row->text(0), std::to_string(schema_steps() - 1)) << "each step is a minor version";
}

TEST_P(RepositoryOn, AFailedTransactionLeavesItsConnectionUsable) {
  for (int i = 0; i < 3; ++i)
    EXPECT_ERROR(InputError, "no", repository().write([](Transaction& transaction) {
      transaction.add(sample_scenario("a"));
      throw InputError("no");
    }));

  EXPECT_FALSE(add_once(repository(), "k", "a").repeated);
}

ELROM_ON_EACH_DATABASE(RepositoryOn);

TEST(Repository, ADatabaseThatIsNoneOfOursIsRefused) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "repository.sqlite", std::string(4096, 'x'));

  EXPECT_ERROR(InputError, "not a database", Repository({.folder = folder.path()}));
}

TEST(Repository, AnUnknownKindOfDatabaseIsNamed) {
  const test::TemporaryFolder folder;

  EXPECT_ERROR(UsageError, "unknown database: found 'mysql://x', expected sqlite or postgresql://",
               Repository({.folder = folder.path(), .database = "mysql://x"}));
}

TEST(Repository, AServerThatIsAwayIsNamedWithoutItsPassword) {
  if (!ELROM_HAS_POSTGRESQL) GTEST_SKIP() << "a build without PostgreSQL";
  const test::TemporaryFolder folder;

  try {
    Repository({.folder = folder.path(), .database = "postgresql://u:geheim@127.0.0.1:1/x"});
    FAIL();
  } catch (const SystemError& error) {
    EXPECT_THAT(error.what(),
                ::testing::HasSubstr("database cannot be used in postgresql://u@127.0.0.1:1/x"));
    EXPECT_THAT(error.what(), ::testing::Not(::testing::HasSubstr("geheim")));
  }
}

TEST(Repository, ABuildWithoutPostgresqlSaysSo) {
  if (ELROM_HAS_POSTGRESQL) GTEST_SKIP() << "a build with PostgreSQL";
  const test::TemporaryFolder folder;

  EXPECT_ERROR(NotBuiltError, "this build has no PostgreSQL",
               Repository({.folder = folder.path(), .database = "postgresql://u@x/y"}));
}

TEST(Repository, APostgresqlServerThatDiesIsUsedAgainWhenItIsBack) {
  if (!ELROM_HAS_POSTGRESQL || !test::PostgresqlServer::available()) GTEST_SKIP() << "no PostgreSQL";
  const test::TemporaryFolder folder;
  test::PostgresqlServer server;
  Repository repository({.folder = folder.path(), .database = server.url()});
  add_once(repository, "k", "a");

  server.stop(SIGKILL);
  // A worker may answer once more before it notices that its server is gone.
  std::string fault;
  for (int i = 0; i < 500 && fault.empty(); ++i) {
    try {
      add_once(repository, "try " + std::to_string(i), "t" + std::to_string(i));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    } catch (const SystemError& error) {
      fault = error.what();
    }
  }
  EXPECT_THAT(fault, ::testing::HasSubstr("database cannot be used"));
  server.start();

  EXPECT_TRUE(add_once(repository, "k", "a").repeated);
  EXPECT_FALSE(add_once(repository, "l", "b").repeated);
}

}  // namespace
}  // namespace elrom::repository
