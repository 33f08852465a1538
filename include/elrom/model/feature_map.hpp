#pragma once
// Derived inputs: what a model makes of a case's boundary conditions before it compares cases, for example
// the gas velocity over the solids' diameter, or an inlet's share of the gas flow. Stored with the model, so
// prediction needs no knowledge of the furnace.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "elrom/io/tensor_file.hpp"

namespace elrom::model {

/// offset + sum of weight_i * inputs[index_i]
struct LinearForm {
  std::vector<std::int32_t> inputs;
  std::vector<double> weights;
  double offset = 0;

  [[nodiscard]] double value(std::span<const double> all_inputs) const;
};

/// One summand of a feature. Logarithms and quotients are
/// held above `floor`, so that no input gives infinity.
struct FeatureTerm {
  enum class Kind { value, square, logarithm, quotient };
  Kind kind = Kind::value;
  double coefficient = 1;
  LinearForm form;
  LinearForm denominator;  ///< of a quotient
  double floor = 0;  ///< smallest argument of a logarithm, smallest denominator; positive for both kinds
};

struct Feature {
  std::string name;  ///< for people: "gas velocity / diameter"
  std::vector<FeatureTerm> terms;

  [[nodiscard]] double value(std::span<const double> inputs) const;
};

/// Thread rule: const use from any thread.
class FeatureMap {
 public:
  FeatureMap() = default;
  explicit FeatureMap(std::vector<Feature> features, std::size_t n_inputs);

  [[nodiscard]] std::size_t n_inputs() const { return n_inputs_; }
  [[nodiscard]] std::size_t size() const { return features_.size(); }
  [[nodiscard]] const std::vector<Feature>& features() const { return features_; }
  /// @param inputs SI, (n_inputs) @param out (size())
  void evaluate(std::span<const double> inputs, std::span<double> out) const;

  void save(io::TensorFile& file, const std::string& key) const;
  /// @throws InputError for a broken description or an index out of range
  [[nodiscard]] static FeatureMap load(const io::TensorFile& file, const std::string& key);

 private:
  std::vector<Feature> features_;
  std::size_t n_inputs_ = 0;
};

}  // namespace elrom::model
