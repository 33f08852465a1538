#pragma once
// Validity guard: where a case lies among the training cases, before anyone believes its prediction.

#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::model {

enum class Verdict { inside, edge, outside };
[[nodiscard]] std::string_view name_of(Verdict verdict);

struct Neighbour {
  std::string name;
  double load = 0;
  double distance = 0;  ///< in standardised inputs, root mean square over inputs
};

struct Assessment {
  Verdict verdict = Verdict::inside;
  std::string reason;                     ///< one sentence, with the user's units
  std::vector<std::string> out_of_range;  ///< "primary_air 250 kg/s (trained 150 to 212)"
  double distance = 0;                    ///< joint distance to the training cases
  /// Share of training cases at least as far from the others (leave-one-out), (k + 1) / (n + 1)
  double p_value = 1;
  std::vector<Neighbour> nearest;  ///< three, nearest first
};

/// Thread rule: const use from any thread.
class Guard {
 public:
  Guard() = default;
  /// @param inputs SI, (n_cases, n_inputs)
  Guard(const field::InputSchema& schema, const MatrixD& inputs, std::vector<std::string> names,
        std::vector<double> loads);
  /// Judges a case. @throws NumericalError when an input is not finite
  [[nodiscard]] Assessment assess(std::span<const double> inputs) const;
  /// `inputs` moved to at most one trained width outside the trained range, input by input; one that lies
  /// nearer is not changed by a bit. @param held (n_inputs)
  void hold(std::span<const double> inputs, std::span<double> held) const;

  void save(io::TensorFile& file, const std::string& prefix) const;
  [[nodiscard]] static Guard load(const io::TensorFile& file, const std::string& prefix,
                                  const field::InputSchema& schema);

 private:
  void find_ranges();

  field::InputSchema schema_;
  MatrixD inputs_;  //!< training inputs, SI, (n_cases, n_inputs)
  std::vector<std::string> names_;
  std::vector<double> loads_;
  std::vector<double> self_distance_;  //!< of every training case to the others, ascending, (n_cases)
  std::vector<double> low_, high_;     //!< trained range, (n_inputs)
};

}  // namespace elrom::model
