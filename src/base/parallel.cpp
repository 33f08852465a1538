#include "elrom/base/parallel.hpp"

#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <atomic>
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

/// A thread that begins on another processor than its creator's. Left to itself, the kernel often queues a new thread behind its
/// creator and moves it only milliseconds later, at its next balancing: a whole prediction is no longer than that.
/// Once running, the thread may go wherever the process may.
class Helper {
 public:
  explicit Helper(std::function<void()> work) : work_(std::move(work)), allowed_(allowed_processors()) {
    cpu_set_t others = allowed_;
    const int here = sched_getcpu();
    if (here >= 0) CPU_CLR(static_cast<std::size_t>(here), &others);
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    if (CPU_COUNT(&others) > 0) pthread_attr_setaffinity_np(&attributes, sizeof others, &others);
    running_ = pthread_create(&thread_, &attributes, begin, this) == 0;
    pthread_attr_destroy(&attributes);
  }
  ~Helper() {
    if (running_) pthread_join(thread_, nullptr);
  }
  Helper(const Helper&) = delete;
  Helper& operator=(const Helper&) = delete;

 private:
  static void* begin(void* self) {
    auto* helper = static_cast<Helper*>(self);
    if (CPU_COUNT(&helper->allowed_) > 0) sched_setaffinity(0, sizeof helper->allowed_, &helper->allowed_);
    helper->work_();
    return nullptr;
  }

  std::function<void()> work_;
  cpu_set_t allowed_;
  pthread_t thread_{};
  bool running_ = false;  ///< false where the system gives no more threads: the others do its share
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
  const auto run = [&](int worker) {
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
  {
    const auto helpers =
        std::min<std::size_t>(static_cast<std::size_t>(std::max(1, n_threads)), std::max<std::size_t>(n, 1)) -
        1;
    std::vector<std::unique_ptr<Helper>> threads;
    threads.reserve(helpers);
    for (std::size_t k = 0; k < helpers; ++k)
      threads.push_back(std::make_unique<Helper>([&run, k] { run(static_cast<int>(k) + 1); }));
    run(0);
  }
  if (failure) std::rethrow_exception(failure);
  if (next < n && stop.stop_requested()) throw Interrupted("stopped on request");
}

}  // namespace elrom::base
