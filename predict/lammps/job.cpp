#include "job.hpp"

#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "elrom/base/error.hpp"

namespace elrom::lammps {
namespace {

constexpr std::size_t largest_piece = std::size_t{1} << 30;  // MPI counts in int

void broadcast_bytes(void* values, std::size_t n_bytes) {
  auto* at = static_cast<char*>(values);
  while (n_bytes > 0) {
    const std::size_t n = std::min(largest_piece, n_bytes);
    MPI_Bcast(at, static_cast<int>(n), MPI_BYTE, 0, MPI_COMM_WORLD);
    at += n, n_bytes -= n;
  }
}

template <class Values>
void broadcast_values(Values& values) {
  std::uint64_t n = values.size();
  broadcast_bytes(&n, sizeof n);
  values.resize(n);
  broadcast_bytes(values.data(), n * sizeof values[0]);
}

}  // namespace

Job::Job() {
  MPI_Init(nullptr, nullptr);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Job::~Job() { MPI_Finalize(); }

Order Job::order(Order order, double now) {
  struct Word {
    Order order;
    double now;
  } word{order, now};
  broadcast_bytes(&word, sizeof word);
  now_ = word.now;
  return word.order;
}

void Job::broadcast(std::string& text) const { broadcast_values(text); }
void Job::broadcast(std::vector<double>& values) const { broadcast_values(values); }

std::vector<double> Job::gathered(const std::vector<double>& values) const {
  const auto n = static_cast<int>(values.size());
  std::vector<int> counts(static_cast<std::size_t>(size_)), starts(static_cast<std::size_t>(size_));
  MPI_Gather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, MPI_COMM_WORLD);
  std::exclusive_scan(counts.begin(), counts.end(), starts.begin(), 0);
  std::vector<double> all(static_cast<std::size_t>(starts.back() + counts.back()));
  MPI_Gatherv(values.data(), n, MPI_DOUBLE, all.data(), counts.data(), starts.data(), MPI_DOUBLE, 0,
              MPI_COMM_WORLD);
  return all;
}

void Job::sum(std::span<std::int64_t> counts) const {
  std::vector<std::int64_t> sums(counts.size());
  MPI_Reduce(counts.data(), sums.data(), static_cast<int>(counts.size()), MPI_INT64_T, MPI_SUM, 0,
             MPI_COMM_WORLD);
  std::ranges::copy(sums, counts.begin());
}

void Job::abort(const char* why) const {
  std::fprintf(stderr, "error: rank %d: %s; the job ends, run it again to go on\n", rank_, why);
  MPI_Abort(MPI_COMM_WORLD, static_cast<int>(ExitStatus::internal));
  std::abort();
}

}  // namespace elrom::lammps
