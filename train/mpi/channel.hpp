#pragma once
// Tensor files from rank to rank. Waiting costs no processor time: MPI's own waiting spins, and the processor
// it would take is the one that trains.

#include <chrono>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/io/tensor_file.hpp"

namespace elrom::mpi {

/// Waits a little, and longer each time, up to a millisecond.
class Patience {
 public:
  void wait();

 private:
  std::chrono::microseconds pause_{20};
};

/// Thread rule: any thread, one at a time for each other rank.
class Channel {
 public:
  /// Starts MPI. @throws SystemError when it cannot be called from threads
  Channel();
  /// Ends MPI; waits for the other ranks to do so.
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }

  /// Returns when the other side has taken it. A message that breaks off in the middle (for want of memory)
  /// cannot be taken up again: it ends the job, with one line on standard error, as it would hang otherwise.
  void send(int to, const io::TensorFile& message);
  [[nodiscard]] io::TensorFile receive(int from);
  /// nullopt when nothing has come yet.
  [[nodiscard]] std::optional<io::TensorFile> poll(int from);

  /// Ends every process of the job, with one line on standard error.
  [[noreturn]] void abort(const std::string& why) noexcept;

 private:
  template <class Start>
  void transfer(const Start& start);
  void send_whole(int to, const io::TensorFile& message);
  [[nodiscard]] io::TensorFile receive_whole(int from);
  void send_bytes(int to, std::span<const std::byte> bytes);
  void receive_bytes(int from, std::span<std::byte> bytes);

  std::mutex mutex_;  // MPI is called by one thread at a time
  int rank_ = 0, size_ = 1;
};

}  // namespace elrom::mpi
