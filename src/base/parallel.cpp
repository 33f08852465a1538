#include "elrom/base/parallel.hpp"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::base {

int available_threads() {
  cpu_set_t set;
  CPU_ZERO(&set);
  if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
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
    std::vector<std::jthread> threads;
    threads.reserve(helpers);
    for (std::size_t k = 0; k < helpers; ++k) threads.emplace_back(run, static_cast<int>(k) + 1);
    run(0);
  }
  if (failure) std::rethrow_exception(failure);
  if (next < n && stop.stop_requested()) throw Interrupted("stopped on request");
}

}  // namespace elrom::base
