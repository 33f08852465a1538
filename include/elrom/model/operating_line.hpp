#pragma once
// What the other inputs of a case make usual for each input: the line along which a plant is run, and how far
// from it its cases lie. One test for whoever judges inputs: the guard before a prediction, the checks before
// an import.
//
// Inputs are taken to follow one common factor (the load), each with a scatter of its own that grows or
// shrinks along the line. Model, per standardised input j: z_j = a_j t + e_j, t ~ N(0, 1), e_j ~ N(0, s_j);
// a and s by expectation maximisation (Rubin and Thayer, Psychometrika 47, 1982). Usual for input j is its
// conditional mean given all the other inputs. The conditional sigma is the root mean square of what is left
// of each training case when the model is learned without it, times 1 + g (usual - mean), with one g for all
// inputs. Of 26 inputs and 64 cases a full covariance knows too little: it flags 9 % of healthy cases and
// finds half of what one factor finds.
//
// Thread rule: const use from any thread.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::model {

/// By how much a limit must grow that was drawn for many cases, where only n of them tell what is usual:
/// 1 + (few / n)^2. Chosen on stores of 8 to 64 of the 64 shipped training cases, drawn at random.
[[nodiscard]] double growth_for_few(std::size_t n_cases, double few = 20);

/// Of cases like the learned ones, not more than this share is to be flagged.
inline constexpr double most_flagged_share = 0.05;
/// How many of n cases, each judged by the others, may be flagged, so that one more case like them is
/// flagged with at most this probability: k with (k + 1) / (n + 1) <= share (split conformal prediction).
[[nodiscard]] std::size_t most_flagged(std::size_t n_cases);

/// Of one input, SI: "177 +- 11 is usual".
struct UsualInput {
  double value = 0;      ///< conditional mean
  double deviation = 0;  ///< conditional sigma; infinite where nothing is known
  /// How far `given` lies from it, in deviations.
  [[nodiscard]] double distance(double given) const;
};

class OperatingLine {
 public:
  /// Cases from which on it says anything.
  static constexpr std::size_t fewest_cases = 12;

  /// Knows nothing: all is usual.
  OperatingLine() = default;
  /// @param inputs finite, (n_cases, n_inputs). An input that never changes has no say.
  /// @param n_flagged cases that are flagged for other reasons, when each is judged by the others
  explicit OperatingLine(const MatrixD& inputs, std::size_t n_flagged = 0);

  [[nodiscard]] bool knows() const { return learned_ != nullptr; }
  /// Of every input, given all the others, (n_inputs). @param inputs finite, (n_inputs)
  [[nodiscard]] std::vector<UsualInput> usual(std::span<const double> inputs) const;
  /// Deviations from which on an input is unusual: what 2.5 % of the learned cases exceed when each is
  /// judged by the others, or less, down to 2.3 (1 + (8 / n)^2), while no more than most_flagged() are.
  [[nodiscard]] double limit() const { return limit_; }
  /// Deviations from which on no healthy case was met: 1.6 times the limit, more of few cases.
  [[nodiscard]] double far_limit() const;
  /// The same of a learned case by what the other cases know, (n_inputs). Only where it knows() anything.
  [[nodiscard]] std::vector<UsualInput> left_out(std::size_t i_case) const;

 private:
  struct Learned;
  std::shared_ptr<const Learned> learned_;  //!< null: knows nothing
  double limit_ = 0;
};

/// "primary_air 225 kg/s: 177 +- 11 kg/s is usual with these other inputs", in the user's unit.
[[nodiscard]] std::string unusual_text(const field::InputInfo& info, double given, const UsualInput& usual);

}  // namespace elrom::model
