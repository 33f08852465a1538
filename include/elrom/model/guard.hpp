#pragma once
// Validity guard: where a case lies among the training cases, before anyone believes its prediction.

#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/math/matrix.hpp"
#include "elrom/model/operating_line.hpp"

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
  std::string reason;  ///< one sentence, with the user's units
  std::vector<std::string>
      out_of_range;  ///< "primary_air 225 kg/s (trained 150 to 212, 21 % of that width outside)", the worst first
  /// "primary_air 225 kg/s: 177 +- 11 kg/s is usual with these other inputs", the most unusual first
  std::vector<std::string> unusual;
  double distance = 0;  ///< joint distance to the training cases
  /// Share of training cases at least as far from the others (leave-one-out), (k + 1) / (n + 1)
  double p_value = 1;
  std::vector<Neighbour> nearest;  ///< three, nearest first
};

/// Judges by three things, each held against what the training cases say of each other when one of them is
/// left out, so that of cases like them at most about 5 % are flagged: how far an input lies outside the
/// trained range, from what the other inputs make usual (OperatingLine), and how far the case as a whole lies
/// from the training cases. Thread rule: const use from any thread.
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

  // The training cases that it judges by.
  [[nodiscard]] const MatrixD& inputs() const { return inputs_; }  ///< SI, (n_cases, n_inputs)
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] const std::vector<double>& loads() const { return loads_; }  ///< NaN: not told

  /// Trained range of each input, SI, (n_inputs).
  [[nodiscard]] std::span<const double> low() const { return low_; }
  [[nodiscard]] std::span<const double> high() const { return high_; }

  void save(io::TensorFile& file, const std::string& prefix) const;
  [[nodiscard]] static Guard load(const io::TensorFile& file, const std::string& prefix,
                                  const field::InputSchema& schema);

 private:
  void learn_inputs();
  // Each sets what it is named after; the verdict is the worst of the three.
  Verdict judge_ranges(std::span<const double> inputs, std::vector<std::string>& out_of_range) const;
  Verdict judge_line(std::span<const double> inputs, std::vector<std::string>& unusual) const;
  Verdict judge_distance(Assessment& result) const;

  field::InputSchema schema_;
  MatrixD inputs_;  //!< training inputs, SI, (n_cases, n_inputs)
  std::vector<std::string> names_;
  std::vector<double> loads_;
  std::vector<double> self_distance_;  //!< of every training case to the others, ascending, (n_cases)
  std::vector<double> low_, high_;     //!< trained range, (n_inputs)
  double edge_excess_ = 0;             //!< trained widths outside the range that are nothing special
  OperatingLine line_;
};

}  // namespace elrom::model
