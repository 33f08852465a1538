#include "elrom/networks/trial_store.hpp"

#include <map>
#include <mutex>

#include "elrom/base/text.hpp"
#include "elrom/sql/database.hpp"
#include "trial_columns.hpp"

namespace elrom::networks {
namespace {

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

Trial trial_of(const sql::Statement& row, int first) {
  Trial trial;
  const int rest = read_hyperparameters(row, first, trial.hyperparameters);
  trial.i_seed = static_cast<int>(row.integer(rest));
  trial.value = row.real(rest + 1);
  trial.epochs = static_cast<int>(row.integer(rest + 2));
  trial.pruned = row.integer(rest + 3) != 0;
  trial.diverged = row.integer(rest + 4) != 0;
  trial.seconds = row.real(rest + 5);
  trial.rungs = rungs_of(row.text(rest + 6));
  return trial;
}

}  // namespace

struct TrialStore::Impl {
  explicit Impl(const std::filesystem::path& path) : database(path, io::kinds::trials, schema) {}
  sql::Database database;
  mutable std::mutex mutex;

  // A file from before a hyperparameter was searched holds trials at its default.
  void add_missing_columns() const {
    if (missing_columns().empty()) return;
    database.run("BEGIN IMMEDIATE");
    for (const auto& name : missing_columns())  // asked again: another process may have been first
      database.run("ALTER TABLE trials ADD COLUMN " + declaration_with_default(name));
    database.run("COMMIT");
  }
  [[nodiscard]] std::vector<std::string> missing_columns() const {
    std::vector<std::string> missing;
    for (const auto& name : hyperparameter_columns) {
      auto row = database.prepare("SELECT 1 FROM pragma_table_info('trials') WHERE name = ?");
      if (!row.bind(1, name).next()) missing.push_back(name);
    }
    return missing;
  }
};

TrialStore::TrialStore(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {
  impl_->add_missing_columns();
}

TrialStore::~TrialStore() = default;

std::optional<Trial> TrialStore::find(const std::string& search, const std::string& key, int i_seed) const {
  const std::scoped_lock lock(impl_->mutex);
  const auto sql =
      std::string("SELECT ") + columns + " FROM trials WHERE search = ? AND key = ? AND i_seed = ?";
  auto row = impl_->database.prepare(sql);
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
  auto row = impl_->database.prepare(sql);
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
  auto row = impl_->database.prepare(sql);
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
