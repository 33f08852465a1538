#pragma once
// A learned function from a few numbers to a few numbers: what stands inside a surrogate.

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <string>

#include "elrom/io/tensor_file.hpp"

namespace elrom::particle {

/// (n, number of quantities): column k holds quantity k of all samples.
using Table = Eigen::ArrayXXd;

/// Thread rule: const use from any thread.
class Regressor {
 public:
  virtual ~Regressor() = default;
  [[nodiscard]] virtual std::string kind() const = 0;  ///< "trees", "chebyshev", "network"
  [[nodiscard]] virtual std::size_t n_inputs() const = 0;
  [[nodiscard]] virtual std::size_t n_outputs() const = 0;
  /// @param inputs (n, n_inputs) @param outputs (n, n_outputs), overwritten
  virtual void evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const = 0;
  /// Tensors under "<prefix>/...".
  virtual void write(io::TensorFile& file, const std::string& prefix) const = 0;
};

/// By the kind that the file names under "<prefix>/kind".
/// @throws InputError for an unknown kind, for shapes, indices or values that cannot be evaluated safely
[[nodiscard]] std::unique_ptr<Regressor> read_regressor(const io::TensorFile& file,
                                                        const std::string& prefix);

}  // namespace elrom::particle
