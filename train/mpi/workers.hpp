#pragma once
// Rank 0's side: who is free, who holds which data, and the conversation about one unit.

#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "channel.hpp"
#include "elrom/networks/workers.hpp"

namespace elrom::mpi {

/// Rank 0 and the others as places for a unit each.
class Places {
 public:
  explicit Places(int n_ranks) : places_(static_cast<std::size_t>(n_ranks)) {}

  /// A place that is this caller's until it goes.
  class Lease {
   public:
    Lease(Places& places, int rank) : places_(places), rank_(rank) {}
    ~Lease() { places_.give_back(rank_); }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    [[nodiscard]] int rank() const { return rank_; }
    /// Notes that the rank holds this data from now on. @return whether it did not before
    [[nodiscard]] bool bring(const std::string& data);

   private:
    Places& places_;
    int rank_;
  };
  /// Waits for a free place: one that holds the data, else this process, else any.
  [[nodiscard]] Lease lease(const std::string& data);

 private:
  struct Place {
    bool taken = false;
    std::string data;
  };
  void give_back(int rank);

  std::mutex mutex_;
  std::condition_variable freed_;
  std::vector<Place> places_;
};

[[nodiscard]] std::unique_ptr<networks::Workers> make_workers(Channel& channel);

}  // namespace elrom::mpi
