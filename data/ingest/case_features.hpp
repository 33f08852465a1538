#pragma once
// Logarithmic features of a case in which a mistaken unit shows as a jump: every input, every measure of the
// fields, and ratios that physics ties to a narrow range whatever the furnace.

#include <optional>
#include <string>
#include <vector>

#include "elrom/ingest/case_summary.hpp"

namespace elrom::ingest {

/// true value = factor * value as read + offset, for some inputs and all cells of some fields at once.
struct Correction {
  std::string quantity;     ///< "primary_air", "pressure", "all gas flows"
  std::string description;  ///< "values in t/h taken for kg/s"
  double factor = 1, offset = 0;
  std::vector<std::size_t> inputs;
  std::vector<std::string> fields;
};

/// A feature's name, and the range that physics leaves it (natural logarithm), if it does.
struct FeatureInfo {
  std::string name;  ///< as in messages: "primary_air", "gas flux against the inlets' flow"
  std::optional<std::pair<double, double>> range = {};
};

class CaseFeatures {
 public:
  /// Features of cases with these inputs. Which input is which is told by its SI unit: kg/s flows of gas, K
  /// the gas temperature, kg the solids' inventory, m the solids' size.
  explicit CaseFeatures(const field::InputSchema& schema);

  [[nodiscard]] const std::vector<FeatureInfo>& infos() const { return infos_; }
  /// Natural logarithms; NaN where a quantity is missing or not positive.
  /// @param correction applied first, when not null
  [[nodiscard]] std::vector<double> evaluate(const CaseSummary& summary,
                                             const Correction* correction = nullptr) const;
  /// Features that a correction may change.
  [[nodiscard]] std::vector<std::size_t> touched(const Correction& correction) const;
  /// Features that grow with the boiler's load: the gas flows, or the velocities where no flows are known.
  [[nodiscard]] const std::vector<std::size_t>& load_features() const { return load_features_; }

 private:
  void add_ratios();

  field::InputSchema schema_;
  std::vector<FeatureInfo> infos_;
  std::vector<std::size_t> flows_, load_features_;
  std::optional<std::size_t> temperature_, inventory_, size_;
};

}  // namespace elrom::ingest
