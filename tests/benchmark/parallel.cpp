// bench-parallel: what one call of base::parallel_for costs beside starting threads anew,
// as a simulation feels it that makes one call a time step: the same small pieces of
// arithmetic, one a thread, by the team, by new threads, and on one thread.

#include "elrom/base/parallel.hpp"

#include <nlohmann/json.hpp>
#include <thread>

#include "support/benchmark.hpp"

namespace {

using namespace elrom;

/// Some microseconds of arithmetic that the compiler cannot leave out.
void piece(double& value) {
  for (int i = 0; i < 10'000; ++i) value = value * 0.999999 + 1e-6;
}

template <class Call>
double microseconds_of(int n_calls, const Call& call) {
  for (int i = 0; i < n_calls / 10; ++i) call();
  const benchmark::Stopwatch watch;
  for (int i = 0; i < n_calls; ++i) call();
  return watch.seconds() / n_calls * 1e6;
}

nlohmann::ordered_json measure(const benchmark::Arguments& arguments) {
  const int n_calls = arguments.small ? 10'000 : 100'000;
  struct alignas(64) Value {
    double value = 1;
  };
  std::vector<Value> values(static_cast<std::size_t>(arguments.threads));
  const double team = microseconds_of(n_calls, [&] {
    base::parallel_for(values.size(), arguments.threads, [&](std::size_t i, int) { piece(values[i].value); });
  });
  const double anew = microseconds_of(n_calls, [&] {
    std::vector<std::jthread> threads;
    for (std::size_t i = 1; i < values.size(); ++i) threads.emplace_back([&, i] { piece(values[i].value); });
    piece(values[0].value);
  });
  const double alone = microseconds_of(n_calls, [&] {
    for (auto& value : values) piece(value.value);
  });
  return {{"threads", arguments.threads},
          {"calls", n_calls},
          {"microseconds_per_call", team},
          {"microseconds_with_new_threads", anew},
          {"microseconds_on_one_thread", alone}};
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main("bench-parallel", "A call of parallel_for beside new threads.",
                                          "not used", argc, argv, measure);
}
