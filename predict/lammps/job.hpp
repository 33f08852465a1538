#pragma once
// The processes of a job, and what they tell each other beside LAMMPS. Rank 0 gives orders. Internal.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace elrom::lammps {

enum class Order : int { begin, step, gather, end };

class Job {
 public:
  Job();
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool leads() const { return rank_ == 0; }

  /// Rank 0 says it, the others hear it. @param now time of rank 0's scene, s
  Order order(Order order, double now);
  [[nodiscard]] double now() const { return now_; }  ///< of the last order

  /// Rank 0's, at all ranks.
  void broadcast(std::string& text) const;
  void broadcast(std::vector<double>& values) const;
  /// All ranks' values one after another, at rank 0; elsewhere none.
  [[nodiscard]] std::vector<double> gathered(const std::vector<double>& values) const;
  /// At rank 0 the sums over all; elsewhere nothing is left.
  void sum(std::span<std::int64_t> counts) const;

  /// Ends all processes, with a line that says why.
  [[noreturn]] void abort(const char* why) const;

 private:
  int rank_ = 0, size_ = 1;
  double now_ = 0;
};

}  // namespace elrom::lammps
