#pragma once
// The records of a training problem as LibTorch sees them, and how batches are taken from them.

#include <torch/types.h>

#include <cstdint>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"
#include "mlp.hpp"

namespace elrom::torch {

/// On the CPU a view of the caller's matrices, which must outlive it; elsewhere a copy on the device.
class Records {
 public:
  Records(const MatrixF& inputs, const MatrixF& targets, const MatrixF& weights, Place place);

  [[nodiscard]] std::int64_t size() const { return inputs_.size(0); }
  [[nodiscard]] bool weighted() const { return weights_.defined(); }
  /// Number of targets that count, over all records.
  [[nodiscard]] double n_targets() const;
  /// The same over some records.
  [[nodiscard]] double n_targets(std::span<const std::int64_t> rows) const;
  /// Copies records into a pass of as many rows.
  void gather(std::span<const std::int64_t> rows, Pass& pass) const;

 private:
  bool own_loops_;
  ::torch::Tensor inputs_, targets_, weights_;
  std::vector<float> counts_;  //!< targets that count, of every record; empty when all count
};

}  // namespace elrom::torch
