#pragma once
// A small network between standardised inputs and outputs, in float32.

#include "elrom/math/standardiser.hpp"
#include "elrom/model/network.hpp"
#include "elrom/particle/regressor.hpp"

namespace elrom::particle {

class NetworkRegressor final : public Regressor {
 public:
  /// @throws InputError for scalers of other sizes than the network's, or with a scale that is not positive
  NetworkRegressor(math::Standardiser inputs, math::Standardiser outputs, model::Network network);

  [[nodiscard]] std::string kind() const override { return "network"; }
  [[nodiscard]] std::size_t n_inputs() const override { return network_.n_inputs(); }
  [[nodiscard]] std::size_t n_outputs() const override { return network_.n_outputs(); }
  void evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const override;
  void write(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<NetworkRegressor> read(const io::TensorFile& file,
                                                              const std::string& prefix);

 private:
  math::Standardiser inputs_, outputs_;
  model::Network network_;
};

}  // namespace elrom::particle
