#pragma once
// The symmetric part of a field over its scale, as a field of its own: on one column of each orbit, over the
// symmetric parts of the inputs, without mirrors. It has less noise than the field, fewer cells and in effect
// fewer inputs. Internal to methods.

#include <memory>
#include <optional>
#include <span>

#include "elrom/model/composite_models.hpp"
#include "fundamental_domain.hpp"

namespace elrom::methods {

/// Thread rule: const use from any thread.
class SymmetricPart {
 public:
  /// @param data of all its cases; the part keeps what it needs of it
  /// @param cases that the scale is learned from, as by the kernel method
  SymmetricPart(const field::FieldData& data, std::span<const std::size_t> cases, const FitContext& context);
  SymmetricPart(const SymmetricPart&) = delete;
  SymmetricPart& operator=(const SymmetricPart&) = delete;

  [[nodiscard]] const field::FieldData& data() const { return data_; }
  /// Of the whole field. @param own of data() @param asymmetry nullptr: none
  [[nodiscard]] std::unique_ptr<model::FieldModel> model(
      std::unique_ptr<model::FieldModel> own, std::unique_ptr<model::FieldModel> asymmetry = nullptr) const;
  /// Columns of the whole field for each of data()'s.
  [[nodiscard]] std::size_t orbit_size() const;

 private:
  [[nodiscard]] bool is_whole() const { return domain_.n_cells() == domain_.n_all_cells(); }
  void take_cases(const field::CaseSet& all);

  FundamentalDomain domain_;
  model::FeatureMap inputs_;             // symmetric parts
  std::optional<model::Feature> scale_;  // its logarithm
  field::CaseSet cases_;
  field::FieldData data_;
};

}  // namespace elrom::methods
