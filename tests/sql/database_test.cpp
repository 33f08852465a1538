#include "elrom/sql/database.hpp"

#include <gmock/gmock.h>
#include <sqlite3.h>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::sql {
namespace {

using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr io::FileKind ours{"elrom-test", {2, 1}, "make it anew"};
constexpr const char* schema = "CREATE TABLE IF NOT EXISTS t (i INTEGER, x REAL, s TEXT)";

/// By SQLite itself, behind the component's back.
void execute(const std::filesystem::path& path, const std::string& sql) {
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &raw), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(raw, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(raw);
  sqlite3_close(raw);
}

TEST(Database, ValuesOfEveryTypeReadBackExactly) {
  const TemporaryFolder folder;
  const std::string text("a \0 'quoted' \xC2\xB5m", 15);
  {
    const Database database(folder / "a.sqlite", ours, schema);
    database.prepare("INSERT INTO t VALUES (?, ?, ?)")
        .bind(1, std::int64_t{1} << 40)
        .bind(2, 0.1 + 0.2)
        .bind(3, text)
        .next();
    database.prepare("INSERT INTO t VALUES (?, ?, ?)").bind(1, -3).bind(3, std::string_view()).next();
  }
  const Database database(folder / "a.sqlite", ours, schema);

  auto row = database.prepare("SELECT i, x, s, s IS NULL FROM t ORDER BY i DESC");

  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.integer(0), std::int64_t{1} << 40);
  EXPECT_EQ(row.real(1), 0.1 + 0.2);
  EXPECT_EQ(row.text(2), text);
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.integer(0), -3);
  EXPECT_EQ(row.real(1), 0);  // NULL
  EXPECT_EQ(row.text(2), "");
  EXPECT_EQ(row.integer(3), 0) << "an empty text is a text";
  EXPECT_FALSE(row.next());
}

TEST(Database, AReaderSeesWhatAnOpenWriterHasCommitted) {
  const TemporaryFolder folder;
  const Database writer(folder / "a.sqlite", ours, schema), reader(folder / "a.sqlite", ours, schema);

  writer.run("INSERT INTO t VALUES (1, 1, 'x'), (2, 2, 'y')");
  auto count = reader.prepare("SELECT count(*) FROM t");

  ASSERT_TRUE(count.next());
  EXPECT_EQ(count.integer(0), 2);
}

TEST(Database, AMistakeInAStatementNamesTheFileAndTheFault) {
  const TemporaryFolder folder;
  const Database database(folder / "a.sqlite", ours, schema);

  EXPECT_ERROR(InputError, "no such table: nowhere", database.run("DELETE FROM nowhere"));
  EXPECT_ERROR(InputError, "a.sqlite", static_cast<void>(database.prepare("SELECT q FROM t")));
  EXPECT_ERROR(InputError, "a.sqlite", database.prepare("SELECT i FROM t").bind(1, 1));
}

TEST(Database, AStepThatFailsIsNotTheEndOfTheRows) {
  const TemporaryFolder folder;
  const Database database(folder / "a.sqlite", ours, "CREATE TABLE IF NOT EXISTS t (i INTEGER UNIQUE)");
  database.run("INSERT INTO t VALUES (1)");

  EXPECT_ERROR(InputError, "UNIQUE", database.prepare("INSERT INTO t VALUES (1)").next());
}

TEST(Database, OnlyABrokenFileIsSaidToNeedAnother) {
  const TemporaryFolder folder;
  const auto sound = folder / "a.sqlite", broken = folder / "b.sqlite";
  const Database database(sound, ours, schema);
  test::write_bytes(broken, std::string(4096, 'x'));

  EXPECT_THAT([&] { database.run("DELETE FROM nowhere"); },
              ::testing::ThrowsMessage<InputError>(::testing::Not(::testing::HasSubstr("make it anew"))));
  EXPECT_ERROR(InputError, "make it anew", Database(broken, ours, schema));
}

TEST(Database, AFileOfAnotherKindOrVersionIsRefusedAndLeftAsItIs) {
  const TemporaryFolder folder;
  const auto path = folder / "a.sqlite";
  struct Case {
    std::string content, message;
  };
  const std::string about = "CREATE TABLE about (key TEXT PRIMARY KEY, value); INSERT INTO about VALUES ";
  for (
      const auto& [content, message] :
      {Case{"CREATE TABLE songs (name TEXT)", "found no kind, expected elrom-test"},
       Case{about + "('kind', 'elrom-trials'), ('format_major', 2)",
            "found elrom-trials, expected elrom-test"},
       Case{
           about + "('kind', 'elrom-test'), ('format_major', 3), ('format_minor', 0), ('program', 'ELROM 9')",
           "found elrom-test 3.0, expected elrom-test 2.x; use the ELROM that wrote it (ELROM 9), or make it anew"},
       Case{about + "('kind', 'elrom-test'), ('format_major', 1), ('format_minor', 4)",
            "found elrom-test 1.4"},
       Case{about + "('kind', 'elrom-test')", "found elrom-test without a version"}}) {
    std::filesystem::remove(path);
    execute(path, content);
    const auto before = base::sha256_file(path);

    EXPECT_ERROR(InputError, message, Database(path, ours, schema));

    EXPECT_EQ(base::sha256_file(path), before);
  }
}

TEST(Database, ANewerMinorVersionIsOpened) {
  const TemporaryFolder folder;
  { const Database database(folder / "a.sqlite", ours, schema); }
  execute(folder / "a.sqlite", "UPDATE about SET value = 9 WHERE key = 'format_minor'");

  EXPECT_NO_THROW(Database(folder / "a.sqlite", ours, schema));
}

TEST(Database, AFileThatIsNoDatabaseIsRefused) {
  const TemporaryFolder folder;
  base::write_text(folder / "a.sqlite", std::string(200, 'x'));

  EXPECT_ERROR(InputError, "not a database", Database(folder / "a.sqlite", ours, schema));
}

TEST(Database, AnEmptyFileBecomesADatabaseOfThisKind) {
  const TemporaryFolder folder;
  base::write_text(folder / "a.sqlite", "");

  { const Database database(folder / "a.sqlite", ours, schema); }

  const Database again(folder / "a.sqlite", ours, schema);
  auto row = again.prepare("SELECT value FROM about WHERE key = 'kind'");
  ASSERT_TRUE(row.next());
  EXPECT_EQ(row.text(0), "elrom-test");
}

}  // namespace
}  // namespace elrom::sql
