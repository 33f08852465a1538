#include "elrom/networks/trial_store.hpp"

#include <array>
#include <map>
#include <mutex>

#include "elrom/base/text.hpp"
#include "elrom/sql/database.hpp"

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

using Row = TrialOf<NamedValues>;

const char* column_type(const NamedValue& named) {
  static constexpr std::array types{"REAL", "INTEGER", "TEXT"};
  return types[named.value.index()];
}

// "learning_rate REAL, n_layers INTEGER, ..."
std::string column_declarations(const NamedValues& hyperparameters) {
  std::vector<std::string> columns;
  for (const auto& named : hyperparameters) columns.push_back(named.name + " " + column_type(named));
  return base::join(columns, ", ");
}

std::string column_names(const NamedValues& hyperparameters) {
  std::vector<std::string> names;
  for (const auto& named : hyperparameters) names.push_back(named.name);
  return base::join(names, ", ") + ", i_seed, value, epochs, pruned, diverged, seconds, rungs";
}

std::string schema(const std::string& table, const NamedValues& hyperparameters) {
  return "CREATE TABLE IF NOT EXISTS " + table +
         " (number INTEGER PRIMARY KEY, search TEXT NOT NULL, name TEXT, key TEXT NOT NULL, " +
         column_declarations(hyperparameters) +
         ", i_seed INTEGER NOT NULL, value REAL NOT NULL, epochs INTEGER, pruned INTEGER, diverged INTEGER, "
         "seconds REAL, rungs TEXT, UNIQUE (search, key, i_seed))";
}

}  // namespace

struct TrialTable::Impl {
  Impl(const std::filesystem::path& path, std::string table_name, NamedValues wanted)
      : table(std::move(table_name)),
        defaults(std::move(wanted)),
        columns(column_names(defaults)),
        database(path, io::kinds::trials, schema(table, defaults)) {}
  std::string table;
  NamedValues defaults;
  std::string columns;
  sql::Database database;
  mutable std::mutex mutex;

  // A file from before a hyperparameter was searched holds trials at its default.
  void add_missing_columns() const {
    if (missing_columns().empty()) return;
    database.run("BEGIN IMMEDIATE");
    for (const auto& named : missing_columns())  // asked again: another process may have been first
      database.run("ALTER TABLE " + table + " ADD COLUMN " + named.name + " " + column_type(named) +
                   " DEFAULT '" + key_of({named}) + "'");
    database.run("COMMIT");
  }
  [[nodiscard]] NamedValues missing_columns() const {
    NamedValues missing;
    for (const auto& named : defaults) {
      auto row = database.prepare("SELECT 1 FROM pragma_table_info(?) WHERE name = ?");
      if (!row.bind(1, table).bind(2, named.name).next()) missing.push_back(named);
    }
    return missing;
  }
  // first: number of the first hyperparameter's column.
  [[nodiscard]] Row trial_of(const sql::Statement& row, int first) const {
    Row trial{.hyperparameters = defaults};
    int i = first;
    for (auto& named : trial.hyperparameters) {
      if (std::holds_alternative<std::string>(named.value))
        named.value = row.text(i++);
      else if (std::holds_alternative<int>(named.value))
        named.value = static_cast<int>(row.real(i++));
      else
        named.value = row.real(i++);
    }
    trial.i_seed = static_cast<int>(row.integer(i));
    trial.value = row.real(i + 1);
    trial.epochs = static_cast<int>(row.integer(i + 2));
    trial.pruned = row.integer(i + 3) != 0;
    trial.diverged = row.integer(i + 4) != 0;
    trial.seconds = row.real(i + 5);
    trial.rungs = rungs_of(row.text(i + 6));
    return trial;
  }
};

TrialTable::TrialTable(const std::filesystem::path& path, const std::string& table, NamedValues defaults)
    : impl_(std::make_unique<Impl>(path, table, std::move(defaults))) {
  impl_->add_missing_columns();
}

TrialTable::~TrialTable() = default;

std::optional<Row> TrialTable::find(const std::string& search, const std::string& key, int i_seed) const {
  const std::scoped_lock lock(impl_->mutex);
  auto row = impl_->database.prepare("SELECT " + impl_->columns + " FROM " + impl_->table +
                                     " WHERE search = ? AND key = ? AND i_seed = ?");
  row.bind(1, search).bind(2, key).bind(3, i_seed);
  if (!row.next()) return std::nullopt;
  return impl_->trial_of(row, 0);
}

void TrialTable::add(const std::string& search, const std::string& name, const std::string& key,
                     const Row& trial) {
  const std::scoped_lock lock(impl_->mutex);
  const std::vector<std::string> values(impl_->defaults.size(), "?");
  auto row = impl_->database.prepare("INSERT OR REPLACE INTO " + impl_->table + " (search, name, key, " +
                                     impl_->columns + ") VALUES (?, ?, ?, " + base::join(values, ", ") +
                                     ", ?, ?, ?, ?, ?, ?, ?)");
  row.bind(1, search).bind(2, name).bind(3, key);
  int rest = 4;
  for (const auto& named : trial.hyperparameters)
    std::visit([&](const auto& value) { row.bind(rest++, value); }, named.value);
  row.bind(rest, trial.i_seed)
      .bind(rest + 1, trial.value)
      .bind(rest + 2, trial.epochs)
      .bind(rest + 3, trial.pruned ? 1 : 0)
      .bind(rest + 4, trial.diverged ? 1 : 0)
      .bind(rest + 5, trial.seconds)
      .bind(rest + 6, rungs_text(trial.rungs))
      .next();
}

std::vector<TrialTable::SearchOf<NamedValues>> TrialTable::searches() const {
  const std::scoped_lock lock(impl_->mutex);
  auto row = impl_->database.prepare("SELECT search, name, " + impl_->columns + " FROM " + impl_->table +
                                     " ORDER BY number");
  std::vector<SearchOf<NamedValues>> result;
  std::map<std::string, std::size_t> place;
  while (row.next()) {
    const auto [entry, is_new] = place.try_emplace(row.text(0), result.size());
    if (is_new) result.push_back({row.text(0), row.text(1), {}});
    result[entry->second].trials.push_back(impl_->trial_of(row, 2));
  }
  return result;
}

}  // namespace elrom::networks
