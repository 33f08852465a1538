#pragma once
// Mode coefficients by a few small networks on all coefficients at once (peer "pod_mlp").

#include <Eigen/Core>
#include <string>
#include <vector>

#include "elrom/model/coefficient_model.hpp"
#include "elrom/model/network.hpp"
#include "elrom/model/scaler.hpp"

namespace elrom::model {

/// coefficient_j = scale_j * mean over builds of output_j. Thread rule: const use from any number of threads,
/// each with a Workspace of its own.
class MlpCoefficients final : public CoefficientModel {
 public:
  struct Parts {
    InputScaler inputs;
    Eigen::VectorXd scale;     //!< of each coefficient, (n_coefficients)
    Eigen::VectorXd variance;  //!< of each coefficient's error on validation cases, (n_coefficients)
    std::vector<Network> builds;
    std::vector<double> scores;  //!< validation error of each build, (n_builds)
    std::string recipe = {};     //!< by which they were trained, for who trains again; empty: not known
  };
  /// @throws InputError when the parts do not fit
  explicit MlpCoefficients(Parts parts);

  [[nodiscard]] std::string kind() const override { return "mlp"; }
  [[nodiscard]] std::size_t n_inputs() const override { return parts_.inputs.size(); }
  [[nodiscard]] std::size_t n_coefficients() const override {
    return static_cast<std::size_t>(parts_.scale.size());
  }
  [[nodiscard]] const Parts& parts() const { return parts_; }
  /// @param variance the validation error's, or the builds' own where that is larger
  void predict(std::span<const double> inputs, std::span<double> coefficients, std::span<double> variance,
               bool best_build_only, Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<CoefficientModel> load(const io::TensorFile& file,
                                                              const std::string& prefix);

 private:
  Parts parts_;
};

}  // namespace elrom::model
