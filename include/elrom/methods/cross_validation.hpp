#pragma once
// Folds of cases, and predictions by models that did not see their fold.

#include <functional>
#include <span>
#include <vector>

#include "elrom/methods/method.hpp"

namespace elrom::methods {

/// Folds made of blocks of neighbouring loads, so that a case's nearest loads leave the training set with it.
/// The sorted cases are cut into n_folds * blocks_per_fold blocks that are dealt to the folds in turn: every
/// fold spans the range of loads, and none asks only for extrapolation.
/// @param loads (n_cases); a load that is not given (NaN) counts as the largest
/// @param cases rows that take part @param n_folds reduced to the number of cases when there are fewer
/// @return at least two folds, each with its rows ascending. @throws UsageError for fewer than two cases
[[nodiscard]] Folds load_grouped_folds(std::span<const double> loads, std::span<const std::size_t> cases,
                                       std::size_t n_folds, std::size_t blocks_per_fold = 2);

/// Folds that take every n-th case in the order of loads: what is left out lies
/// among what is left, as a new case lies among the cases of a study. Cases of
/// equal inputs (repeated runs) stay together, unless all are equal.
/// @param rows that take part @param n_folds, the return value and errors as above
[[nodiscard]] Folds spread_folds(const field::CaseSet& cases, std::span<const std::size_t> rows,
                                 std::size_t n_folds);

/// The same folds, which more cases have joined: each that of the case among them whose load is nearest (of
/// equally near ones the first). Models of the folds as they were have seen nothing of the new ones.
[[nodiscard]] Folds joined(Folds folds, std::span<const double> loads, std::span<const std::size_t> more);

/// What `make` makes of the rows; with a warm start of those that it knows, which the others have joined.
[[nodiscard]] Folds folds_of(std::span<const std::size_t> rows, std::span<const double> loads,
                             const FitContext& context,
                             const std::function<Folds(std::span<const std::size_t>)>& make);

/// All rows of `folds` but those of fold `left_out`, ascending.
[[nodiscard]] std::vector<std::size_t> rows_without(const Folds& folds, std::size_t left_out);

/// One row of values on all planes, (n_cells).
void predict_case(const model::FieldModel& model, std::span<const double> inputs, std::size_t n_planes,
                  std::span<float> values, model::Workspace& workspace);

/// Method::predict_folds by one fit for each fold that is wanted; `parallel` runs them side by side
/// (for methods whose fit() may run on several threads).
[[nodiscard]] MatrixF predict_by_fitting(const Method& method, const field::FieldData& data,
                                         const Folds& folds, std::span<const std::size_t> wanted,
                                         const FitContext& context, bool parallel);

}  // namespace elrom::methods
