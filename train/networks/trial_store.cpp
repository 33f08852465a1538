#include "elrom/networks/trial_store.hpp"

#include <sqlite3.h>

#include <map>
#include <mutex>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "trial_columns.hpp"

namespace elrom::networks {
namespace {

constexpr int format_major = 1;

class Statement {
 public:
  Statement(sqlite3* database, const std::string& where, const char* sql)
      : database_(database), where_(where) {
    require(sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr) == SQLITE_OK);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(int i, const std::string& text) {
    require(sqlite3_bind_text(statement_, i, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT) ==
            SQLITE_OK);
    return *this;
  }
  Statement& bind(int i, int value) {
    require(sqlite3_bind_int(statement_, i, value) == SQLITE_OK);
    return *this;
  }
  Statement& bind(int i, double value) {
    require(sqlite3_bind_double(statement_, i, value) == SQLITE_OK);
    return *this;
  }
  /// @return whether there is a row
  bool next() {
    const int result = sqlite3_step(statement_);
    require(result == SQLITE_ROW || result == SQLITE_DONE);
    return result == SQLITE_ROW;
  }
  [[nodiscard]] int whole(int i) const { return sqlite3_column_int(statement_, i); }
  [[nodiscard]] double real(int i) const { return sqlite3_column_double(statement_, i); }
  [[nodiscard]] std::string text(int i) const {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, i));
    return text == nullptr ? std::string() : std::string(text);
  }

 private:
  void require(bool ok) const {
    if (!ok)
      throw InputError({.what = "trial store cannot be used",
                        .where = where_,
                        .found = sqlite3_errmsg(database_),
                        .advice = "remove the file to search anew"});
  }
  sqlite3* database_;
  const std::string& where_;
  sqlite3_stmt* statement_ = nullptr;
};

std::string rungs_text(const std::vector<double>& rungs) {
  std::vector<std::string> parts;
  for (const double value : rungs) parts.push_back(base::number(value));
  return base::join(parts, " ");
}

std::vector<double> rungs_of(const std::string& text) {
  std::vector<double> rungs;
  if (text.empty()) return rungs;
  for (const auto& part : base::split(text, ' ')) rungs.push_back(base::to_double(part).value_or(0));
  return rungs;
}

const std::vector<std::string> hyperparameter_columns(hyperparameter_names.begin(),
                                                      hyperparameter_names.end());
const std::string columns =
    base::join(hyperparameter_columns, ", ") + ", i_seed, value, epochs, pruned, diverged, seconds, rungs";

const std::string schema =
    "CREATE TABLE IF NOT EXISTS trials (number INTEGER PRIMARY KEY, search TEXT NOT NULL, name TEXT, key "
    "TEXT NOT NULL, " +
    base::join(column_declarations(), ", ") +
    ", i_seed INTEGER NOT NULL, value REAL NOT NULL, epochs INTEGER, pruned INTEGER, diverged INTEGER, "
    "seconds REAL, rungs TEXT, UNIQUE (search, key, i_seed))";

Trial trial_of(const Statement& row, int first) {
  Trial trial;
  const int rest = read_hyperparameters(row, first, trial.hyperparameters);
  trial.i_seed = row.whole(rest);
  trial.value = row.real(rest + 1);
  trial.epochs = row.whole(rest + 2);
  trial.pruned = row.whole(rest + 3) != 0;
  trial.diverged = row.whole(rest + 4) != 0;
  trial.seconds = row.real(rest + 5);
  trial.rungs = rungs_of(row.text(rest + 6));
  return trial;
}

}  // namespace

struct TrialStore::Impl {
  sqlite3* database = nullptr;
  std::string where;
  mutable std::mutex mutex;

  ~Impl() { sqlite3_close(database); }
  void run(const char* sql) const { Statement(database, where, sql).next(); }
  // A file from before a hyperparameter was searched holds trials at its default.
  void add_missing_columns() const {
    for (const auto& name : hyperparameter_columns) {
      Statement row(database, where, "SELECT 1 FROM pragma_table_info('trials') WHERE name = ?");
      if (!row.bind(1, name).next())
        run(("ALTER TABLE trials ADD COLUMN " + declaration_with_default(name)).c_str());
    }
  }
  void check_version() const {
    Statement row(database, where, "SELECT value FROM about WHERE key = 'format_major'");
    const int found = row.next() ? row.whole(0) : 0;
    if (found == format_major) return;
    throw InputError({.what = "trial store of another version",
                      .where = where,
                      .found = std::to_string(found),
                      .expected = std::to_string(format_major),
                      .advice = "remove the file to search anew"});
  }
};

TrialStore::TrialStore(const std::filesystem::path& path) : impl_(std::make_unique<Impl>()) {
  impl_->where = path.string();
  if (sqlite3_open(path.c_str(), &impl_->database) != SQLITE_OK) {
    throw InputError({.what = "trial store cannot be opened",
                      .where = path.string(),
                      .found = sqlite3_errmsg(impl_->database)});
  }
  sqlite3_busy_timeout(impl_->database, 10000);
  impl_->run("PRAGMA journal_mode = WAL");
  impl_->run("PRAGMA synchronous = NORMAL");
  impl_->run("BEGIN IMMEDIATE");
  impl_->run("CREATE TABLE IF NOT EXISTS about (key TEXT PRIMARY KEY, value)");
  impl_->run(schema.c_str());
  Statement(impl_->database, impl_->where,
            "INSERT OR IGNORE INTO about VALUES ('kind', 'elrom-trials'), ('format_major', 1), "
            "('format_minor', 0), ('program', ?)")
      .bind(1, program_version())
      .next();
  impl_->run("COMMIT");
  impl_->check_version();
  impl_->add_missing_columns();
}

TrialStore::~TrialStore() = default;

std::optional<Trial> TrialStore::find(const std::string& search, const std::string& key, int i_seed) const {
  const std::scoped_lock lock(impl_->mutex);
  const auto sql =
      std::string("SELECT ") + columns + " FROM trials WHERE search = ? AND key = ? AND i_seed = ?";
  Statement row(impl_->database, impl_->where, sql.c_str());
  row.bind(1, search).bind(2, key).bind(3, i_seed);
  if (!row.next()) return std::nullopt;
  return trial_of(row, 0);
}

void TrialStore::add(const std::string& search, const std::string& name, const std::string& key,
                     const Trial& trial) {
  const std::scoped_lock lock(impl_->mutex);
  const auto sql = std::string("INSERT OR REPLACE INTO trials (search, name, key, ") + columns +
                   ") VALUES (?, ?, ?, " +
                   base::join(std::vector<std::string>(hyperparameter_columns.size(), "?"), ", ") +
                   ", ?, ?, ?, ?, ?, ?, ?)";
  Statement row(impl_->database, impl_->where, sql.c_str());
  row.bind(1, search).bind(2, name).bind(3, key);
  const int rest = bind_hyperparameters(row, 4, trial.hyperparameters);
  row.bind(rest, trial.i_seed)
      .bind(rest + 1, trial.value)
      .bind(rest + 2, trial.epochs)
      .bind(rest + 3, trial.pruned ? 1 : 0)
      .bind(rest + 4, trial.diverged ? 1 : 0)
      .bind(rest + 5, trial.seconds)
      .bind(rest + 6, rungs_text(trial.rungs))
      .next();
}

std::vector<TrialStore::Search> TrialStore::searches() const {
  const std::scoped_lock lock(impl_->mutex);
  const auto sql = std::string("SELECT search, name, ") + columns + " FROM trials ORDER BY number";
  Statement row(impl_->database, impl_->where, sql.c_str());
  std::vector<Search> result;
  std::map<std::string, std::size_t> place;
  while (row.next()) {
    const auto [entry, is_new] = place.try_emplace(row.text(0), result.size());
    if (is_new) result.push_back({row.text(0), row.text(1), {}});
    result[entry->second].trials.push_back(trial_of(row, 2));
  }
  return result;
}

}  // namespace elrom::networks
