// PostgreSQL by its own C library: libpqxx 6 would be a second layer over the same three calls, and its
// parameters are those of the compiler's argument lists, not of a list made at run time.
#include "database.hpp"
#include "elrom/base/error.hpp"

#if ELROM_HAS_POSTGRESQL
#include <libpq-fe.h>

#include <cstdlib>

#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#endif

namespace elrom::repository {

#if ELROM_HAS_POSTGRESQL
namespace {

/// Of all ELROM repositories of a server: who looks at the schema is alone.
constexpr const char* schema_lock = "SELECT pg_advisory_xact_lock(1162628685)";

using Result = std::unique_ptr<PGresult, decltype(&PQclear)>;

class PostgresqlRows final : public DbRows {
 public:
  explicit PostgresqlRows(Result result) : result_(std::move(result)) {}
  bool next() override { return ++row_ < PQntuples(result_.get()); }
  [[nodiscard]] std::int64_t integer(int i) const override { return std::strtoll(cell(i), nullptr, 10); }
  [[nodiscard]] double real(int i) const override { return base::to_double(cell(i)).value_or(0); }
  [[nodiscard]] std::string text(int i) const override { return cell(i); }

 private:
  [[nodiscard]] const char* cell(int i) const { return PQgetvalue(result_.get(), row_, i); }

  Result result_;
  int row_ = -1;
};

std::string text_of(const DbValue& value) {
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&value)) return base::number(*real);
  return std::get<std::string>(value);
}

class PostgresqlConnection final : public Connection {
 public:
  /// @param where without its password, for messages
  PostgresqlConnection(const std::string& url, std::string where)
      : where_(std::move(where)), connection_(PQconnectdb(url.c_str()), &PQfinish) {
    if (PQstatus(connection_.get()) != CONNECTION_OK) fail(PQerrorMessage(connection_.get()));
    PQsetNoticeProcessor(
        connection_.get(), [](void*, const char*) {}, nullptr);
    check_kind();
  }

  std::unique_ptr<DbRows> query(const std::string& sql, const DbValues& values) override {
    std::vector<std::string> texts;
    for (const auto& value : values) texts.push_back(text_of(value));
    std::vector<const char*> pointers;
    for (const auto& text : texts) pointers.push_back(text.c_str());
    return std::make_unique<PostgresqlRows>(
        checked(PQexecParams(connection_.get(), sql.c_str(), static_cast<int>(pointers.size()), nullptr,
                             pointers.data(), nullptr, nullptr, 0)));
  }
  void begin(bool writes) override {
    run(writes ? "BEGIN ISOLATION LEVEL REPEATABLE READ" : "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY");
  }
  void commit() override { run("COMMIT"); }
  void rollback() noexcept override { PQclear(PQexec(connection_.get(), "ROLLBACK")); }
  [[nodiscard]] bool is_sound() const override {
    return PQstatus(connection_.get()) == CONNECTION_OK &&
           PQtransactionStatus(connection_.get()) == PQTRANS_IDLE;
  }

 private:
  void run(const char* sql) { (void)checked(PQexec(connection_.get(), sql)); }

  Result checked(PGresult* raw) {
    Result result(raw, &PQclear);
    const auto status = PQresultStatus(raw);
    if (status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK) return result;
    const char* code = raw == nullptr ? nullptr : PQresultErrorField(raw, PG_DIAG_SQLSTATE);
    const std::string state = code == nullptr ? "" : code;
    if (state == "40001" || state == "40P01") throw LostRace();  // serialization failure, deadlock
    fail(raw == nullptr ? PQerrorMessage(connection_.get()) : PQresultErrorMessage(raw));
  }

  [[noreturn]] void fail(const char* message) const {
    throw SystemError(
        Problem{.what = "database cannot be used", .where = where_, .found = base::trim(message)});
  }

  /// The table `about` of our SQLite files (data/FORMATS.md).
  void check_kind() {
    const auto& kind = io::kinds::repository;
    run("BEGIN");
    run(schema_lock);
    run("CREATE TABLE IF NOT EXISTS about (key TEXT PRIMARY KEY, value TEXT)");
    query(
        "INSERT INTO about VALUES ('kind', $1), ('format_major', $2), ('format_minor', $3), ('program', $4) "
        "ON CONFLICT DO NOTHING",
        {std::string(kind.name), std::to_string(kind.version.major), std::to_string(kind.version.minor),
         program_version()});
    io::FoundKind found{about("kind"), about("format_major") + "." + about("format_minor"), about("program")};
    run("COMMIT");
    io::check_kind(found, kind, where_);
  }
  std::string about(const std::string& key) {
    const auto row = query("SELECT value FROM about WHERE key = $1", {key});
    return row->next() ? row->text(0) : std::string();
  }

  std::string where_;
  std::unique_ptr<PGconn, decltype(&PQfinish)> connection_;
};

/// "postgresql://user:secret@host/name" without the secret.
std::string without_password(std::string url) {
  const auto at = url.find('@');
  const auto colon = url.find(':', std::string("postgresql://").size());
  if (at != std::string::npos && colon < at) url.erase(colon, at - colon);
  return url.substr(0, url.find('?'));
}

class PostgresqlBackend final : public Backend {
 public:
  explicit PostgresqlBackend(std::string url) : url_(std::move(url)) {}
  std::unique_ptr<Connection> connect() override {
    return std::make_unique<PostgresqlConnection>(url_, without_password(url_));
  }
  [[nodiscard]] std::string numbering() const override {
    return "BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY";
  }
  [[nodiscard]] std::string own_number() const override { return "OVERRIDING SYSTEM VALUE"; }
  void number_on(Connection& connection, const std::string& table) const override {
    connection.query("SELECT setval(pg_get_serial_sequence('" + table + "', 'id'), (SELECT max(id) FROM " +
                         table + ")) FROM " + table + " LIMIT 1",
                     {});
  }
  void lock_schema(Connection& connection) const override { connection.query(schema_lock, {}); }

 private:
  std::string url_;
};

}  // namespace

std::unique_ptr<Backend> make_postgresql_backend(const std::string& url) {
  return std::make_unique<PostgresqlBackend>(url);
}

#else

std::unique_ptr<Backend> make_postgresql_backend(const std::string& /*url*/) {
  throw NotBuiltError(Problem{.what = "this build has no PostgreSQL",
                              .advice = "build with -DELROM_POSTGRESQL=ON (needs libpq-dev), or use sqlite"});
}

#endif

}  // namespace elrom::repository
