#include "records.hpp"

#include <cstring>

#include "elrom/base/error.hpp"

namespace elrom::torch {
namespace {

using ::torch::Tensor;

Tensor view_of(const MatrixF& matrix, ::torch::Device device) {
  const auto view = ::torch::from_blob(const_cast<float*>(matrix.data()), {matrix.rows(), matrix.cols()},
                                       ::torch::kFloat32);
  return view.to(device);
}

void gather_rows(const Tensor& from, std::span<const std::int64_t> rows, bool own_loops, Tensor& to) {
  if (own_loops) {
    const auto width = static_cast<std::size_t>(from.size(1));
    const float* source = from.data_ptr<float>();
    float* target = to.data_ptr<float>();
    for (const std::int64_t row : rows) {
      std::memcpy(target, source + static_cast<std::size_t>(row) * width, width * sizeof(float));
      target += width;
    }
    return;
  }
  const auto index = ::torch::from_blob(const_cast<std::int64_t*>(rows.data()),
                                        {static_cast<std::int64_t>(rows.size())}, ::torch::kInt64)
                         .to(from.device());
  at::index_select_out(to, from, 0, index);
}

}  // namespace

Records::Records(const MatrixF& inputs, const MatrixF& targets, const MatrixF& weights, Place place)
    : own_loops_(place.own_loops),
      inputs_(view_of(inputs, place.device)),
      targets_(view_of(targets, place.device)) {
  check(inputs.rows() == targets.rows(), "as many inputs as targets");
  if (weights.size() == 0) return;
  check(weights.rows() == targets.rows() && weights.cols() == targets.cols(), "a weight for every target");
  weights_ = view_of(weights, place.device);
  counts_.resize(static_cast<std::size_t>(weights.rows()));
  Eigen::Map<Eigen::VectorXf>(counts_.data(), weights.rows()) = weights.rowwise().sum();
}

double Records::n_targets() const {
  double sum = 0;
  for (const float count : counts_) sum += static_cast<double>(count);
  return counts_.empty() ? static_cast<double>(targets_.numel()) : sum;
}

double Records::n_targets(std::span<const std::int64_t> rows) const {
  if (counts_.empty()) return static_cast<double>(rows.size()) * static_cast<double>(targets_.size(1));
  double sum = 0;
  for (const std::int64_t row : rows) sum += static_cast<double>(counts_[static_cast<std::size_t>(row)]);
  return sum;
}

void Records::gather(std::span<const std::int64_t> rows, Pass& pass) const {
  check(static_cast<std::int64_t>(rows.size()) == pass.n_rows, "a pass of as many rows");
  gather_rows(inputs_, rows, own_loops_, pass.x);
  gather_rows(targets_, rows, own_loops_, pass.target);
  if (weights_.defined()) gather_rows(weights_, rows, own_loops_, pass.weight);
}

}  // namespace elrom::torch
