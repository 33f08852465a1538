#pragma once
// SQLite behind a small owning interface: one file, statements with bound values, a file's kind and version
// in a table `about` (data/FORMATS.md). A reader in another process sees every committed row, and a killed
// writer loses only what was not committed (write-ahead log).
//
// Every failure of SQLite becomes an InputError that names the file. Columns and
// parameters count from 1 where SQLite's do (bind) and from 0 where they do
// (columns). Thread rule: one thread at a time for a database and its statements.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "elrom/io/file_kind.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace elrom::sql {

class Database;

/// One compiled statement. Its database must outlive it.
class Statement {
 public:
  ~Statement();
  Statement(Statement&& other) noexcept;
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  Statement& operator=(Statement&&) = delete;

  /// @param i from 1
  Statement& bind(int i, std::string_view text);
  Statement& bind(int i, const char* text) { return bind(i, std::string_view(text)); }
  Statement& bind(int i, std::int64_t value);
  Statement& bind(int i, int value) { return bind(i, std::int64_t{value}); }
  Statement& bind(int i, double value);
  /// Takes a step. @return whether there is a row
  bool next();
  /// Of the present row; `i` from 0. A value of another type is
  /// converted as SQLite does; NULL gives 0 and "".
  [[nodiscard]] std::int64_t integer(int i) const;
  [[nodiscard]] double real(int i) const;
  [[nodiscard]] std::string text(int i) const;

 private:
  friend class Database;
  Statement(const Database& database, std::string_view sql);
  void require(bool ok) const;

  const Database* database_;
  sqlite3_stmt* statement_ = nullptr;
};

class Database {
 public:
  /// Opens the file, or makes one of this kind where there is none or an empty one.
  /// @param schema statements that make the tables (CREATE TABLE IF NOT EXISTS ...), separated by ';'
  /// @throws InputError when it is no SQLite file, of another kind, of another
  /// major version, or cannot be opened; such a file is left as it is
  Database(const std::filesystem::path& path, const io::FileKind& kind, const std::string& schema);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  [[nodiscard]] Statement prepare(std::string_view sql) const { return {*this, sql}; }
  /// One or several statements without values or rows.
  void run(const std::string& sql) const;
  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  friend class Statement;
  [[nodiscard]] bool is_empty() const;
  [[nodiscard]] io::FoundKind found_kind() const;
  [[noreturn]] void fail() const;

  std::string where_, remedy_;
  sqlite3* database_ = nullptr;
};

}  // namespace elrom::sql
