#include "elrom/repository/backup.hpp"

#include <set>
#include <thread>

#include "backends.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/sql/database.hpp"
#include "schema.hpp"
#include "support/throws.hpp"

namespace elrom::repository {
namespace {

class BackupOn : public EachDatabase {
 protected:
  /// A scenario with a run that is done, and its fields.
  void add(const std::string& name) {
    const auto digest = repository().fields().put("fields of " + name);
    repository().write([&](Transaction& t) {
      const auto scenario = t.add(sample_scenario(name));
      t.know({.digest = digest, .bytes = 10, .by = "x"});
      t.add_run(scenario.id, "elrom", {}, "x");
      const auto run = *t.claim("elrom", "w", 60);
      t.give_back(run.id, run.lease, {.result = {.version = "1", .fields = digest}, .ask = {"next"}});
    });
  }
  /// All that can be asked, as one text.
  static std::string content(Repository& of) {
    std::string text;
    of.read([&](Transaction& t) {
      text.clear();
      for (const auto& s : t.scenarios({}))
        text += std::to_string(s.id) + s.name + s.note + std::to_string(s.load);
      for (const auto& r : t.runs({}, {})) text += r.model + r.worker + std::to_string(r.sources.size());
      for (const auto& r : t.results(1, {})) text += r.version + of.fields().read(r.fields);
      for (const auto& one : t.tokens()) text += one.name;
    });
    return text;
  }
};

TEST_P(BackupOn, IsARepositoryOfItsOwnWithAllThatWasThere) {
  add("a");
  std::string secret;
  repository().write([&](Transaction& t) { secret = t.make_token("me", Role::admin); });

  const auto copied = back_up(options(), folder_ / "backup");

  EXPECT_EQ(copied.files, 1);
  Repository backup({.folder = folder_ / "backup"});
  EXPECT_EQ(content(backup), content(repository()));
  backup.read([&](Transaction& t) { EXPECT_EQ(t.token_of(secret)->name, "me"); });
}

TEST_P(BackupOn, IsRestoredIntoAnEmptyRepositoryThatGoesOn) {
  add("a");
  add("b");
  back_up(options(), folder_ / "backup");
  const auto before = content(repository());
  close();
  SetUp();  // another, empty database
  std::filesystem::remove_all(options().folder);

  const auto copied = restore(folder_ / "backup", options());

  EXPECT_EQ(copied.files, 2);
  EXPECT_EQ(content(repository()), before);
  repository().write([](Transaction& t) { EXPECT_EQ(t.add(sample_scenario("c")).id, 3); });
}

TEST_P(BackupOn, IsOfOneMomentWhileOthersWrite) {
  add("first");
  std::jthread writer([&](const std::stop_token& stop) {
    for (int i = 0; !stop.stop_requested(); ++i) add(std::to_string(i));
  });

  for (int i = 0; i < 5; ++i) {
    const auto place = folder_ / ("backup" + std::to_string(i));
    back_up(options(), place);
    Repository backup({.folder = place});
    backup.read([&](Transaction& t) {
      const auto scenarios = t.scenarios({.n = 100000});
      EXPECT_EQ(t.runs({}, {.n = 100000}).size(), scenarios.size() + 1) << "all ask for one more";
      for (const auto& scenario : scenarios) {
        const auto results = t.results(scenario.id, {});
        ASSERT_EQ(results.size(), 1U);
        EXPECT_EQ(backup.fields().read(results[0].fields), "fields of " + scenario.name);
      }
    });
  }
}

TEST_P(BackupOn, NothingIsOverwritten) {
  add("a");
  back_up(options(), folder_ / "backup");

  EXPECT_ERROR(UsageError, "something is there already", back_up(options(), folder_ / "backup"));
  EXPECT_ERROR(UsageError, "the repository is not empty", restore(folder_ / "backup", options()));
  EXPECT_ERROR(InputError, "no backup", restore(folder_ / "nowhere", options()));
}

TEST_P(BackupOn, ADamagedFileIsFoundAndLeavesNothingBehind) {
  add("a");
  const auto file =
      repository().fields().path(base::sha256(std::as_bytes(std::span(std::string_view("fields of a")))));
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  test::write_bytes(file, "fields of b");

  EXPECT_ERROR(InputError, "damaged file of fields", back_up(options(), folder_ / "backup"));

  EXPECT_FALSE(std::filesystem::exists(folder_ / "backup"));
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    EXPECT_EQ(entry.path().filename(), "store");
}

ELROM_ON_EACH_DATABASE(BackupOn);

TEST(Backup, CopiesEveryTableAndColumnOfTheSchema) {
  const test::TemporaryFolder folder;
  Repository({.folder = folder.path()});
  const sql::Database database(folder / "repository.sqlite", io::kinds::repository, "");
  std::set<std::string> known, there;
  for (const auto& table : tables())
    for (const auto& column : table.columns) known.insert(table.name + "." + column.name);
  auto rows = database.prepare(
      "SELECT m.name || '.' || c.name FROM sqlite_master m, pragma_table_info(m.name) c WHERE m.type = 'table' "
      "AND m.name NOT IN ('about', 'schema_steps', 'sqlite_sequence')");
  while (rows.next()) there.insert(rows.text(0));

  EXPECT_EQ(known, there);
}

}  // namespace
}  // namespace elrom::repository
