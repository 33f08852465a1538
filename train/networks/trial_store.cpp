#include "elrom/networks/trial_store.hpp"

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

constexpr const char* columns =
    "learning_rate, n_layers, n_units, batch_size, weight_decay, dropout, activation, i_seed, value, epochs, "
    "pruned, "
    "diverged, seconds, rungs";

constexpr const char* schema =
    "CREATE TABLE IF NOT EXISTS trials (number INTEGER PRIMARY KEY, search TEXT NOT NULL, name TEXT, key "
    "TEXT NOT NULL, learning_rate REAL, n_layers INTEGER, n_units INTEGER, batch_size INTEGER, weight_decay "
    "REAL, dropout REAL, activation TEXT, i_seed INTEGER NOT NULL, value REAL NOT NULL, epochs INTEGER, "
    "pruned INTEGER, diverged INTEGER, seconds REAL, rungs TEXT, UNIQUE (search, key, i_seed))";

Trial trial_of(const sql::Statement& row, int first) {
  const auto whole = [&](int i) { return static_cast<int>(row.integer(i)); };
  Trial trial;
  auto& h = trial.hyperparameters;
  h.learning_rate = row.real(first);
  h.n_layers = whole(first + 1);
  h.n_units = whole(first + 2);
  h.batch_size = whole(first + 3);
  h.weight_decay = row.real(first + 4);
  h.dropout = row.real(first + 5);
  h.activation = model::activation_of(row.text(first + 6));
  trial.i_seed = whole(first + 7);
  trial.value = row.real(first + 8);
  trial.epochs = whole(first + 9);
  trial.pruned = row.integer(first + 10) != 0;
  trial.diverged = row.integer(first + 11) != 0;
  trial.seconds = row.real(first + 12);
  trial.rungs = rungs_of(row.text(first + 13));
  return trial;
}

}  // namespace

struct TrialStore::Impl {
  explicit Impl(const std::filesystem::path& path) : database(path, io::kinds::trials, schema) {}
  sql::Database database;
  mutable std::mutex mutex;
};

TrialStore::TrialStore(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}

TrialStore::~TrialStore() = default;

std::optional<Trial> TrialStore::find(const std::string& search, const std::string& key, int i_seed) const {
  const std::scoped_lock lock(impl_->mutex);
  auto row = impl_->database.prepare(std::string("SELECT ") + columns +
                                     " FROM trials WHERE search = ? AND key = ? AND i_seed = ?");
  row.bind(1, search).bind(2, key).bind(3, i_seed);
  if (!row.next()) return std::nullopt;
  return trial_of(row, 0);
}

void TrialStore::add(const std::string& search, const std::string& name, const std::string& key,
                     const Trial& trial) {
  const std::scoped_lock lock(impl_->mutex);
  const auto insert = std::string("INSERT OR REPLACE INTO trials (search, name, key, ") + columns +
                      ") VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)";
  const auto& h = trial.hyperparameters;
  impl_->database.prepare(insert)
      .bind(1, search)
      .bind(2, name)
      .bind(3, key)
      .bind(4, h.learning_rate)
      .bind(5, h.n_layers)
      .bind(6, h.n_units)
      .bind(7, h.batch_size)
      .bind(8, h.weight_decay)
      .bind(9, h.dropout)
      .bind(10, std::string(model::name_of(h.activation)))
      .bind(11, trial.i_seed)
      .bind(12, trial.value)
      .bind(13, trial.epochs)
      .bind(14, trial.pruned ? 1 : 0)
      .bind(15, trial.diverged ? 1 : 0)
      .bind(16, trial.seconds)
      .bind(17, rungs_text(trial.rungs))
      .next();
}

std::vector<TrialStore::Search> TrialStore::searches() const {
  const std::scoped_lock lock(impl_->mutex);
  auto row = impl_->database.prepare(std::string("SELECT search, name, ") + columns +
                                     " FROM trials ORDER BY number");
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
