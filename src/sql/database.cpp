#include "elrom/sql/database.hpp"

#include <sqlite3.h>

#include <utility>

#include "elrom/base/error.hpp"

namespace elrom::sql {
namespace {

constexpr int patience_ms = 10000;  // while another process writes

}  // namespace

Statement::Statement(const Database& database, std::string_view sql) : database_(&database) {
  require(sqlite3_prepare_v2(database.database_, sql.data(), static_cast<int>(sql.size()), &statement_,
                             nullptr) == SQLITE_OK);
}

Statement::Statement(Statement&& other) noexcept
    : database_(other.database_), statement_(std::exchange(other.statement_, nullptr)) {}

Statement::~Statement() { sqlite3_finalize(statement_); }

Statement& Statement::bind(int i, std::string_view text) {
  // An empty view may have no data, which SQLite would take for NULL.
  require(sqlite3_bind_text(statement_, i, text.empty() ? "" : text.data(), static_cast<int>(text.size()),
                            SQLITE_TRANSIENT) == SQLITE_OK);
  return *this;
}

Statement& Statement::bind(int i, std::int64_t value) {
  require(sqlite3_bind_int64(statement_, i, value) == SQLITE_OK);
  return *this;
}

Statement& Statement::bind(int i, double value) {
  require(sqlite3_bind_double(statement_, i, value) == SQLITE_OK);
  return *this;
}

bool Statement::next() {
  const int result = sqlite3_step(statement_);
  require(result == SQLITE_ROW || result == SQLITE_DONE);
  return result == SQLITE_ROW;
}

std::int64_t Statement::integer(int i) const { return sqlite3_column_int64(statement_, i); }
double Statement::real(int i) const { return sqlite3_column_double(statement_, i); }
std::string Statement::text(int i) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, i));
  return text == nullptr ? std::string()
                         : std::string(text, static_cast<std::size_t>(sqlite3_column_bytes(statement_, i)));
}

void Statement::require(bool ok) const {
  if (!ok) database_->fail();
}

Database::Database(const std::filesystem::path& path, const io::FileKind& kind, const std::string& schema)
    : where_(path.string()), remedy_(kind.remedy) {
  try {
    if (sqlite3_open(path.c_str(), &database_) != SQLITE_OK) fail();
    sqlite3_busy_timeout(database_, patience_ms);
    if (!is_empty()) io::check_kind(found_kind(), kind, where_);
    run("PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; BEGIN IMMEDIATE; "
        "CREATE TABLE IF NOT EXISTS about (key TEXT PRIMARY KEY, value)");
    run(schema);
    prepare(
        "INSERT OR IGNORE INTO about VALUES ('kind', ?), ('format_major', ?), ('format_minor', ?), "
        "('program', ?)")
        .bind(1, kind.name)
        .bind(2, kind.version.major)
        .bind(3, kind.version.minor)
        .bind(4, program_version())
        .next();
    run("COMMIT");
    io::check_kind(found_kind(), kind, where_);  // another process may have been first
  } catch (...) {
    sqlite3_close(database_);
    throw;
  }
}

Database::~Database() { sqlite3_close(database_); }

void Database::run(const std::string& sql) const {
  if (sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

bool Database::is_empty() const {
  auto tables = prepare("SELECT count(*) FROM sqlite_master");
  return tables.next() && tables.integer(0) == 0;
}

io::FoundKind Database::found_kind() const {
  io::FoundKind found;
  auto about = prepare("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = 'about'");
  if (!about.next() || about.integer(0) == 0) return found;
  const auto value = [this](const char* key) -> std::optional<std::string> {
    auto row = prepare("SELECT value FROM about WHERE key = ?");
    row.bind(1, key);
    return row.next() ? std::optional(row.text(0)) : std::nullopt;
  };
  found.kind = value("kind");
  found.program = value("program");
  const auto major = value("format_major"), minor = value("format_minor");
  if (major) found.format = *major + "." + minor.value_or("0");
  return found;
}

// A file that is locked, or on a full disk, is as good as before: what makes it anew is for broken ones.
void Database::fail() const {
  const int code = sqlite3_errcode(database_);
  const bool broken = code == SQLITE_CORRUPT || code == SQLITE_NOTADB;
  throw InputError({.what = "database cannot be used",
                    .where = where_,
                    .found = sqlite3_errmsg(database_),
                    .advice = broken ? remedy_ : std::string()});
}

}  // namespace elrom::sql
