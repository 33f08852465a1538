#pragma once
// What an earlier model of a field knows: where a fit may begin instead of from nothing, when a few cases
// have been added since. A method takes of it what it can use and ignores the rest; what comes out depends on
// the cases, the settings and the earlier model, and on nothing else.
//
// Thread rule: const use from any thread.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elrom/base/members.hpp"
#include "elrom/model/field_model.hpp"
#include "elrom/model/mlp_coefficients.hpp"
#include "elrom/model/smoother_coefficients.hpp"

namespace elrom::methods {

struct WarmStart {
  std::string parent;                              ///< digest of the bundle that the model is from
  std::shared_ptr<const model::FieldModel> model;  ///< nullptr: nothing is known
  /// Rows of the cases, ascending, that networks were planned, trained and cross-validated with before: these
  /// results are in the study's cache, and each network goes on from its own. Empty: networks begin from
  /// nothing.
  std::vector<std::size_t> known = {};

  /// Of all that a result takes from here.
  [[nodiscard]] std::string key() const { return base::digest_of_members(parent, known); }
  [[nodiscard]] std::vector<std::size_t> known_among(std::span<const std::size_t> rows) const;
  /// The kernel smoother that the model is, or that is a part of its blend; nullptr: it has none.
  [[nodiscard]] const model::SmootherCoefficients* smoother() const;
  /// The coefficient networks that the model is, or that are a part of its blend; nullptr: it has none.
  [[nodiscard]] const model::MlpCoefficients* mlp() const;
};

}  // namespace elrom::methods
