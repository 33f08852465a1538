#include "elrom/repository/repository.hpp"

#include <chrono>
#include <mutex>
#include <vector>

#include "database.hpp"
#include "schema.hpp"
#include "transact.hpp"

namespace elrom::repository {
namespace {

double system_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::filesystem::path made(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  return folder;
}

/// What the key was used for before.
std::optional<Answer> answer_of(const Call& call, Connection& connection) {
  const auto row =
      connection.query("SELECT digest, status, body, tag, place FROM calls WHERE key = $1", {call.key});
  if (!row->next()) return std::nullopt;
  if (row->text(0) != call.digest)
    throw ConflictError(Problem{.what = "key used before for another request",
                                .found = "'" + call.key + "'",
                                .advice = "give every new request a key of its own"});
  return Answer{.status = static_cast<int>(row->integer(1)),
                .body = row->text(2),
                .tag = row->text(3),
                .place = row->text(4),
                .repeated = true};
}

/// @return false when another call of the same key is there
bool reserve(const Call& call, double now, Connection& connection) {
  return connection
      .query("INSERT INTO calls VALUES ($1, $2, 0, '', '', '', $3) ON CONFLICT DO NOTHING RETURNING key",
             {call.key, call.digest, now})
      ->next();
}

void keep(const Answer& answer, const std::string& key, Connection& connection) {
  connection.query("UPDATE calls SET status = $1, body = $2, tag = $3, place = $4 WHERE key = $5",
                   {std::int64_t{answer.status}, answer.body, answer.tag, answer.place, key});
}

}  // namespace

struct Repository::Impl {
  std::unique_ptr<Backend> backend;
  std::function<double()> clock;
  std::mutex mutex;
  std::vector<std::unique_ptr<Connection>> idle;  //!< guarded by the mutex

  std::unique_ptr<Connection> take() {
    {
      const std::scoped_lock lock(mutex);
      if (!idle.empty()) {
        auto connection = std::move(idle.back());
        idle.pop_back();
        return connection;
      }
    }
    return backend->connect();
  }
  void put(std::unique_ptr<Connection> connection) {
    if (!connection->is_sound()) return;  // the next one connects anew
    const std::scoped_lock lock(mutex);
    idle.push_back(std::move(connection));
  }

  void transact(bool writes, const std::function<void(Connection&)>& work) {
    auto connection = take();
    try {
      repository::transact(*connection, writes, [&] { work(*connection); });
    } catch (...) {
      put(std::move(connection));
      throw;
    }
    put(std::move(connection));
  }
};

Repository::Repository(RepositoryOptions options)
    : fields_(made(options.folder) / "fields"), impl_(std::make_unique<Impl>()) {
  impl_->backend = open_backend(options.database, options.folder);
  impl_->clock = options.clock ? std::move(options.clock) : system_time;
  auto connection = impl_->backend->connect();
  bring_up(*impl_->backend, *connection);
  impl_->put(std::move(connection));
}
Repository::~Repository() = default;

double Repository::now() const { return impl_->clock(); }

void Repository::read(const Work& work) const {
  impl_->transact(false, [&](Connection& connection) {
    Transaction transaction(connection, now());
    work(transaction);
  });
}

void Repository::write(const Work& work) {
  impl_->transact(true, [&](Connection& connection) {
    Transaction transaction(connection, now());
    work(transaction);
  });
}

Answer Repository::once(const Call& call, const std::function<Answer(Transaction&)>& work) {
  struct NothingDone {};  // leaves no trace, and the disk alone
  Answer answer;
  const auto attempt = [&](Connection& connection) {
    if (auto before = answer_of(call, connection)) {
      answer = std::move(*before);
      return;
    }
    if (!reserve(call, now(), connection)) throw LostRace();  // it came in between: look again
    Transaction transaction(connection, now());
    answer = work(transaction);
    if (!answer.kept) throw NothingDone();
    keep(answer, call.key, connection);
  };
  try {
    impl_->transact(true, attempt);
  } catch (const NothingDone&) {
  }
  return answer;
}

void Repository::forget_calls(double before) {
  impl_->transact(
      true, [&](Connection& connection) { connection.query("DELETE FROM calls WHERE at < $1", {before}); });
}

}  // namespace elrom::repository
