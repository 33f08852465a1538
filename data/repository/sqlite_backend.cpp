#include <mutex>

#include "database.hpp"
#include "elrom/base/error.hpp"
#include "elrom/sql/database.hpp"

namespace elrom::repository {
namespace {

/// A full disk or a locked file is no mistake of who asked.
template <class Work>
auto as_system_error(const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw SystemError(error.problem());
  }
}

class SqliteRows final : public DbRows {
 public:
  explicit SqliteRows(sql::Statement statement) : statement_(std::move(statement)) {
    has_row_ = as_system_error([&] { return statement_.next(); });
  }
  bool next() override {
    if (is_first_) return is_first_ = false, has_row_;
    return has_row_ = has_row_ && as_system_error([&] { return statement_.next(); });
  }
  [[nodiscard]] std::int64_t integer(int i) const override { return statement_.integer(i); }
  [[nodiscard]] double real(int i) const override { return statement_.real(i); }
  [[nodiscard]] std::string text(int i) const override { return statement_.text(i); }

 private:
  sql::Statement statement_;
  bool has_row_ = false, is_first_ = true;
};

/// Writers of this process wait for each other here, in order; SQLite itself would have them look again and
/// again.
class SqliteConnection final : public Connection {
 public:
  SqliteConnection(const std::filesystem::path& file, std::mutex& writing)
      : database_(file, io::kinds::repository, ""), lock_(writing, std::defer_lock) {
    database_.run("PRAGMA synchronous = FULL");  // what was acknowledged outlives a power cut
  }

  std::unique_ptr<DbRows> query(const std::string& sql, const DbValues& values) override {
    auto statement = as_system_error([&] { return database_.prepare(sql); });
    int i = 0;
    for (const auto& value : values)
      std::visit([&](const auto& plain) { statement.bind(++i, plain); }, value);
    return std::make_unique<SqliteRows>(std::move(statement));
  }

  void begin(bool writes) override {
    if (writes) lock_.lock();
    try {
      as_system_error([&] { database_.run(writes ? "BEGIN IMMEDIATE" : "BEGIN"); });
    } catch (...) {
      unlock();
      throw;
    }
  }
  void commit() override {
    as_system_error([&] { database_.run("COMMIT"); });
    unlock();
  }
  void rollback() noexcept override {
    try {
      database_.run("ROLLBACK");
    } catch (...) {  // a full disk has rolled it back already
    }
    unlock();
  }
  [[nodiscard]] bool is_sound() const override { return true; }

 private:
  void unlock() {
    if (lock_.owns_lock()) lock_.unlock();
  }

  sql::Database database_;
  std::unique_lock<std::mutex> lock_;
};

class SqliteBackend final : public Backend {
 public:
  explicit SqliteBackend(std::filesystem::path file) : file_(std::move(file)) {}
  std::unique_ptr<Connection> connect() override {
    return std::make_unique<SqliteConnection>(file_, writing_);
  }
  [[nodiscard]] std::string numbering() const override { return "INTEGER PRIMARY KEY AUTOINCREMENT"; }
  [[nodiscard]] std::string own_number() const override { return ""; }
  void number_on(Connection& /*connection*/, const std::string& /*table*/) const override {}  // by itself
  void lock_schema(Connection& /*connection*/) const override {}  // whoever writes is alone

 private:
  std::filesystem::path file_;
  std::mutex writing_;
};

}  // namespace

std::unique_ptr<Backend> make_sqlite_backend(const std::filesystem::path& file) {
  return std::make_unique<SqliteBackend>(file);
}

std::unique_ptr<Backend> open_backend(const std::string& location, const std::filesystem::path& folder) {
  if (location == "sqlite") return make_sqlite_backend(folder / "repository.sqlite");
  if (location.starts_with("postgresql://")) return make_postgresql_backend(location);
  throw UsageError(Problem{.what = "unknown database",
                           .found = "'" + location + "'",
                           .expected = "sqlite or postgresql://user@host/name"});
}

}  // namespace elrom::repository
