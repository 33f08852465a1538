#pragma once
// Independent pieces of work on a given number of threads. The threads sleep between
// calls, so that a step of a simulation can be one call; nothing spins, so a busy
// neighbour on the machine costs its share of the processor and no more.

#include <cstddef>
#include <functional>
#include <stop_token>

namespace elrom::base {

/// Processors this process may use (affinity and cgroup limits respected by the kernel's mask).
[[nodiscard]] int available_threads();

/// Calls work(i, worker) once for every i in [0, n), worker in [0, n_threads), in increasing
/// order of start. The calling thread takes part. The first exception stops the handing out of
/// work and is thrown again here. Results must not depend on `worker`; then they do not depend
/// on n_threads either. Calls may come from several threads at once, and from inside `work`. A
/// child process forked inside `work` must not return from it.
/// @throws Interrupted when `stop` is requested before all work has been handed out
void parallel_for(std::size_t n, int n_threads, const std::function<void(std::size_t i, int worker)>& work,
                  const std::stop_token& stop = {});

}  // namespace elrom::base
