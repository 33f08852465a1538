#pragma once
// The smoother under the fast screen, by itself for its test.

#include "elrom/networks/screening.hpp"

namespace elrom::networks {

/// Squared residuals of ridge regression on `features` refitted without the record's case, in closed form.
/// @param features (n_records, n_features) @param targets
/// (n_records, n_columns) @return (n_records, n_columns)
[[nodiscard]] MatrixF leave_one_case_out(const MatrixF& features, const MatrixF& targets,
                                         const std::vector<std::int32_t>& case_of, double ridge);

}  // namespace elrom::networks
