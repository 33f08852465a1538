#include "elrom/repository/backup.hpp"

#include <unistd.h>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "schema.hpp"
#include "transact.hpp"

namespace elrom::repository {
namespace {

DbValue value_in(const DbRows& row, int i, ColumnType type) {
  switch (type) {
    case ColumnType::integer:
      return row.integer(i);
    case ColumnType::real:
      return row.real(i);
    case ColumnType::text:
      break;
  }
  return row.text(i);
}

std::string columns_of(const Table& table) {
  std::string text;
  for (const auto& column : table.columns) text += (text.empty() ? "" : ", ") + column.name;
  return text;
}

std::string blanks_of(const Table& table) {
  std::string text;
  for (std::size_t i = 1; i <= table.columns.size(); ++i) text += (i > 1 ? ", $" : "$") + std::to_string(i);
  return text;
}

std::int64_t copy_table(const Table& table, Connection& from, Connection& to, const Backend& target) {
  const auto insert = "INSERT INTO " + table.name + " (" + columns_of(table) + ") " +
                      (table.is_numbered() ? target.own_number() : "") + " VALUES (" + blanks_of(table) + ")";
  const auto rows = from.query("SELECT " + columns_of(table) + " FROM " + table.name, {});
  std::int64_t n = 0;
  for (; rows->next(); ++n) {
    DbValues values;
    for (const auto& column : table.columns)
      values.push_back(value_in(*rows, static_cast<int>(values.size()), column.type));
    to.query(insert, values);
  }
  if (table.is_numbered()) target.number_on(to, table.name);
  return n;
}

/// A backend and a connection to it, brought to the present schema.
struct Opened {
  std::unique_ptr<Backend> backend;
  std::unique_ptr<Connection> connection;
  FieldFiles files;

  explicit Opened(const RepositoryOptions& options)
      : backend(open_backend(options.database, options.folder)),
        connection(backend->connect()),
        files(options.folder / "fields") {
    bring_up(*backend, *connection);
  }
};

bool is_empty(Connection& connection) {
  for (const auto& table : tables()) {
    const auto row = connection.query("SELECT count(*) FROM " + table.name, {});
    if (row->next() && row->integer(0) > 0) return false;
  }
  return true;
}

/// Files first: who reads a row of the copy finds its file.
void copy_files(Opened& from, Opened& to, Copied& copied) {
  const auto rows = from.connection->query("SELECT digest, bytes FROM fields", {});
  for (; rows->next(); ++copied.files) {
    (void)to.files.put(from.files.read(rows->text(0)));
    copied.bytes += rows->integer(1);
  }
}

Copied copy(Opened& from, Opened& to) {
  Copied copied;
  transact(*from.connection, false, [&] {
    copied = {};
    copy_files(from, to, copied);
    transact(*to.connection, true, [&] {
      copied.rows = 0;
      for (const auto& table : tables())
        copied.rows += copy_table(table, *from.connection, *to.connection, *to.backend);
    });
  });
  return copied;
}

/// What people may want to look at later. Nothing there: nothing to copy.
void copy_quarantine(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (std::filesystem::exists(from / "quarantine"))
    std::filesystem::copy(
        from / "quarantine", to / "quarantine",
        std::filesystem::copy_options::recursive | std::filesystem::copy_options::skip_existing);
}

/// Removed with all that is in it, unless it was made the target.
class FolderBeside {
 public:
  explicit FolderBeside(std::filesystem::path target)
      : target_(std::move(target)), folder_(base::temporary_beside(target_)) {
    std::filesystem::create_directories(folder_);
  }
  ~FolderBeside() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  FolderBeside(const FolderBeside&) = delete;
  FolderBeside& operator=(const FolderBeside&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  void commit() { std::filesystem::rename(folder_, target_); }

 private:
  std::filesystem::path target_, folder_;
};

}  // namespace

Copied back_up(const RepositoryOptions& from, const std::filesystem::path& backup) {
  if (std::filesystem::exists(backup))
    throw UsageError(Problem{.what = "something is there already",
                             .where = backup.string(),
                             .advice = "give each backup a folder of its own"});
  if (!std::filesystem::exists(from.folder))
    throw InputError(Problem{.what = "no repository", .where = from.folder.string()});
  FolderBeside folder(std::filesystem::absolute(backup).lexically_normal());
  Copied copied;
  {
    Opened source(from), target({.folder = folder.path()});
    copied = copy(source, target);
  }
  copy_quarantine(from.folder, folder.path());
  folder.commit();
  return copied;
}

Copied restore(const std::filesystem::path& backup, const RepositoryOptions& to) {
  if (!std::filesystem::exists(backup / "repository.sqlite"))
    throw InputError(Problem{.what = "no backup",
                             .where = backup.string(),
                             .expected = "a folder that elrom-serve --backup made"});
  std::filesystem::create_directories(to.folder);
  Opened source({.folder = backup}), target(to);
  if (!is_empty(*target.connection))
    throw UsageError(Problem{.what = "the repository is not empty",
                             .where = to.folder.string(),
                             .advice = "restore into a new folder or database, then serve that one"});
  const auto copied = copy(source, target);
  copy_quarantine(backup, to.folder);
  return copied;
}

}  // namespace elrom::repository
