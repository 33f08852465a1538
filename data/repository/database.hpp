#pragma once
// The database behind the repository, as far as the repository's code sees it: connections, transactions and
// statements of the SQL that SQLite and PostgreSQL have in common. Values are $1, $2, ... in the order of
// their first use. A column that has no value holds 0 or "", so no statement has to ask for NULL.
//
// Every failure is a SystemError that names the database; what lost a race against another transaction is a
// LostRace, and is done again (transact.hpp).
//
// Thread rule: Backend from any thread; a connection and its rows by one thread at a time.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace elrom::repository {

using DbValue = std::variant<std::int64_t, double, std::string>;
using DbValues = std::vector<DbValue>;

/// Rows of one statement, the first after next().
class DbRows {
 public:
  virtual ~DbRows() = default;
  virtual bool next() = 0;
  /// Columns count from 0.
  [[nodiscard]] virtual std::int64_t integer(int i) const = 0;
  [[nodiscard]] virtual double real(int i) const = 0;
  [[nodiscard]] virtual std::string text(int i) const = 0;
};

/// What `read` makes of each row.
template <class Read>
auto list_of(std::unique_ptr<DbRows> rows, const Read& read) {
  std::vector<decltype(read(*rows))> all;
  while (rows->next()) all.push_back(read(*rows));
  return all;
}

/// Another transaction was first.
struct LostRace {};

class Connection {
 public:
  virtual ~Connection() = default;
  /// One statement. Where nothing is read of the rows it is done all the same.
  virtual std::unique_ptr<DbRows> query(const std::string& sql, const DbValues& values) = 0;
  /// A snapshot that sees only its own changes, until one of the other two.
  /// @param writes a reader never waits for a writer
  virtual void begin(bool writes) = 0;
  virtual void commit() = 0;
  virtual void rollback() noexcept = 0;
  /// Whether it may be used again after a failure.
  [[nodiscard]] virtual bool is_sound() const = 0;
};

class Backend {
 public:
  virtual ~Backend() = default;
  [[nodiscard]] virtual std::unique_ptr<Connection> connect() = 0;
  /// Type of a column that numbers its rows.
  [[nodiscard]] virtual std::string numbering() const = 0;
  /// Words of an INSERT that brings such a number along.
  [[nodiscard]] virtual std::string own_number() const = 0;
  /// After such inserts: the next row gets a number above all that are there.
  virtual void number_on(Connection& connection, const std::string& table) const = 0;
  /// Kept from all other processes while the schema is looked at.
  virtual void lock_schema(Connection& connection) const = 0;
};

/// @param location "sqlite": a file in `folder`; "postgresql://user@host/name"
/// @throws UsageError for another, NotBuiltError for one that this build left out
[[nodiscard]] std::unique_ptr<Backend> open_backend(const std::string& location,
                                                    const std::filesystem::path& folder);

[[nodiscard]] std::unique_ptr<Backend> make_sqlite_backend(const std::filesystem::path& file);
[[nodiscard]] std::unique_ptr<Backend> make_postgresql_backend(const std::string& url);

}  // namespace elrom::repository
