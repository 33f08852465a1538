#pragma once
// Method "auto": per field, and per band of columns where that pays, the
// candidate or the blend of candidates that predicts cases best that it has not
// seen, found by load-grouped cross-validation on training cases only.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elrom/methods/method.hpp"
#include "elrom/networks/settings.hpp"

namespace elrom::methods {

struct AutoOptions {
  std::size_t n_folds = 8;
  /// A blend is taken as far as it gains. From this gain on, wholly: the share of the best member's error
  /// that a blend saves in a fold, both chosen by the other folds; half way for half of it. The same for
  /// weights of each band against those of the whole field. A limit that a gain must pass would turn the
  /// model over where a gain lies near it, and another machine's rounding moves gains by a tenth.
  double full_gain = 0.005;
  /// Limits between bands of columns: mean squared error of the best candidate over the column's variance.
  std::vector<double> band_edges = networks::BandSettings{}.edges;
};

struct CandidateScore {
  std::string name;
  /// Cross-validated, against the mean of the cases; NaN: failed. Of one that left early: the best one's
  /// before it, times its error over the other's in the folds that both were tried in.
  double nrmse = 0;
  std::size_t left_after = 0;  ///< folds; 0: it was tried in all
  /// In the final model: (n_columns), or one for all; empty: no part of it
  std::vector<double> weights = {};
  std::string failure = {};

  [[nodiscard]] double mean_weight() const;
};

struct AutoFit {
  std::shared_ptr<const model::FieldModel> model;  ///< fitted on all the cases
  std::vector<CandidateScore> candidates;          ///< in the order given
  double nrmse = 0;  ///< cross-validated, of the final model: a blend's weights are those of the other folds
  double nrmse_by_band = 0;  ///< the same, had each band weights of its own; NaN: all columns in one band
};

/// Candidates are tried in the order given, so the strong and cheap ones come first: a later one leaves
/// after one fold, or after three of six, when the cases in them show that no blend with it can gain (as in
/// the races of Maron & Moore 1994). One that throws NumericalError loses and is told to the log; when all
/// do, the first error is thrown.
/// @param cases rows to learn from; at least two
[[nodiscard]] AutoFit fit_auto(const field::FieldData& data, std::span<const std::size_t> cases,
                               std::span<const Method* const> candidates, const AutoOptions& options,
                               const FitContext& context);

/// Weights with sum 1, none negative, that minimise the squared error of sum_i weight_i * prediction_i,
/// from the candidates' Gram matrix of errors, G_ij = sum of error_i * error_j (n, n), of nine at most:
/// each set of them is tried.
[[nodiscard]] std::vector<double> blend_weights(const Eigen::MatrixXd& error_gram);

/// Square root of the sum of squared errors over that of the rows' deviations from their mean.
[[nodiscard]] double cross_validated_nrmse(const field::FieldData& data, std::span<const std::size_t> cases,
                                           const MatrixF& residuals);

}  // namespace elrom::methods
