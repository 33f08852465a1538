#include "elrom/base/parallel.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::base {

namespace {

cpu_set_t allowed_processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) CPU_ZERO(&set);
  return set;
}

/// What one call wants of one worker. Lives as long as the call.
struct Share {
  const std::function<void(int)>* run = nullptr;
  int number = 0;
  std::fenv_t arithmetic{};  ///< rounding and denormals, as the caller has set them
  cpu_set_t allowed{};       ///< processors, as the caller may use them
};

/// Signals are for the program's own threads, which may be asleep in a call that a signal has to end. Those
/// that a thread causes itself stay its own.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    for (const int own : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP}) sigdelset(&all, own);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_{};
};

/// A thread that sleeps until it is offered a share of a call.
class Worker {
 public:
  /// @return null where the system gives no more threads: the others do its share
  static Worker* start() {
    auto worker = std::unique_ptr<Worker>(new Worker);
    return worker->begin() ? worker.release() : nullptr;
  }

  void offer(const Share& share) {
    const std::scoped_lock lock(mutex_);
    share_ = &share;
    state_ = State::offered;
    changed_.notify_one();
  }
  /// Afterwards the worker does not know the share any more: it
  /// has finished with it, or it never woke up for it.
  void take_back() {
    std::unique_lock lock(mutex_);
    if (state_ == State::offered) state_ = State::idle;
    changed_.wait(lock, [&] { return state_ == State::idle; });
  }
  /// Ends an idle worker, which deletes itself.
  void dismiss() {
    const std::scoped_lock lock(mutex_);
    state_ = State::dismissed;
    changed_.notify_one();
  }

 private:
  enum class State { idle, offered, running, dismissed };

  Worker() : allowed_(allowed_processors()) {}

  /// The thread begins on another processor than its creator's. Left to itself, the kernel often queues a new
  /// thread behind its creator and moves it only milliseconds later, at its next balancing: a whole
  /// prediction is no longer than that. Once running, the thread may go wherever the process may.
  bool begin() {
    cpu_set_t others = allowed_;
    const int here = sched_getcpu();
    if (here >= 0) CPU_CLR(static_cast<std::size_t>(here), &others);
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    if (CPU_COUNT(&others) > 0) pthread_attr_setaffinity_np(&attributes, sizeof others, &others);
    const SignalsBlocked blocked;
    pthread_t thread{};
    const bool running = pthread_create(&thread, &attributes, live, this) == 0;
    pthread_attr_destroy(&attributes);
    return running;
  }

  static void* live(void* self) {
    const std::unique_ptr<Worker> worker(static_cast<Worker*>(self));
    if (CPU_COUNT(&worker->allowed_) > 0) sched_setaffinity(0, sizeof worker->allowed_, &worker->allowed_);
    worker->serve();
    return nullptr;
  }

  void serve() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return state_ == State::offered || state_ == State::dismissed; });
      if (state_ == State::dismissed) return;
      state_ = State::running;
      const Share& share = *share_;
      lock.unlock();
      std::fesetenv(&share.arithmetic);
      move_to(share.allowed);
      (*share.run)(share.number);
      lock.lock();
      state_ = State::idle;
      changed_.notify_one();
    }
  }

  /// The workers of one caller may serve another, who is confined to other processors.
  void move_to(const cpu_set_t& allowed) {
    if (CPU_EQUAL(&allowed, &allowed_) || CPU_COUNT(&allowed) == 0) return;
    if (sched_setaffinity(0, sizeof allowed, &allowed) == 0) allowed_ = allowed;
  }

  cpu_set_t allowed_;
  std::mutex mutex_;
  std::condition_variable changed_;
  State state_ = State::idle;
  const Share* share_ = nullptr;
};

/// The workers that nobody uses at the moment. Calls at the same time,
/// and calls inside calls, find fewer of them and start more.
class Team {
 public:
  /// Never destroyed: its workers sleep in it until the process ends.
  static Team& instance() {
    static auto* team = new Team;
    return *team;
  }

  [[nodiscard]] std::vector<Worker*> lend(std::size_t n) {
    std::vector<Worker*> lent;
    lent.reserve(n);
    {
      const std::scoped_lock lock(mutex_);
      while (lent.size() < n && !idle_.empty()) {
        lent.push_back(idle_.back());
        idle_.pop_back();
      }
    }
    while (lent.size() < n) {
      auto* worker = Worker::start();
      if (worker == nullptr) break;
      lent.push_back(worker);
    }
    return lent;
  }
  void give_back(const std::vector<Worker*>& workers) {
    const std::scoped_lock lock(mutex_);
    for (auto* worker : workers) {
      if (idle_.size() < most_idle)
        idle_.push_back(worker);
      else
        worker->dismiss();
    }
  }

 private:
  static constexpr std::size_t most_idle = 256;

  Team() {
    idle_.reserve(most_idle);
    pthread_atfork([] { instance().mutex_.lock(); }, [] { instance().mutex_.unlock(); }, forget_in_child);
  }
  /// A forked child has one thread: the workers stayed with the
  /// parent, and the child starts its own when it needs them.
  static void forget_in_child() {
    instance().idle_.clear();
    instance().mutex_.unlock();
  }

  std::mutex mutex_;
  std::vector<Worker*> idle_;
};

/// Workers of the team on one call, from the offer of their shares to the end of the last.
class Crew {
 public:
  Crew(std::size_t n, const std::function<void(int)>& run) : shares_(n), workers_(Team::instance().lend(n)) {
    std::fenv_t arithmetic;
    std::fegetenv(&arithmetic);
    const auto allowed = allowed_processors();
    for (std::size_t k = 0; k < workers_.size(); ++k) {
      shares_[k] = {&run, static_cast<int>(k) + 1, arithmetic, allowed};
      workers_[k]->offer(shares_[k]);
    }
  }
  ~Crew() {
    for (auto* worker : workers_) worker->take_back();
    Team::instance().give_back(workers_);
  }
  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

 private:
  std::vector<Share> shares_;
  std::vector<Worker*> workers_;
};

}  // namespace

int available_threads() {
  const auto set = allowed_processors();
  return std::max(1, CPU_COUNT(&set));
}

void parallel_for(std::size_t n, int n_threads, const std::function<void(std::size_t, int)>& work,
                  const std::stop_token& stop) {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  std::mutex mutex;
  const std::function<void(int)> run = [&](int worker) {
    try {
      while (!failed && !stop.stop_requested()) {
        const std::size_t i = next.fetch_add(1);
        if (i >= n) return;
        work(i, worker);
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!failure) failure = std::current_exception();
      failed = true;
    }
  };
  const auto n_workers = std::min<std::size_t>(static_cast<std::size_t>(std::max(1, n_threads)), n);
  if (n_workers > 1) {
    const Crew crew(n_workers - 1, run);
    run(0);
  } else {
    run(0);
  }
  if (failure) std::rethrow_exception(failure);
  if (next < n && stop.stop_requested()) throw Interrupted("stopped on request");
}

}  // namespace elrom::base
