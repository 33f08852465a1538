#pragma once
// Cases compared with each other by their sketches: duplicates, near-duplicates, and cases that lie apart
// from the rest.

#include <span>
#include <vector>

#include "elrom/ingest/case_summary.hpp"

namespace elrom::ingest {

struct Twin {
  std::size_t first = 0, second = 0;
  bool exact = false;   ///< every field value is equal
  double distance = 0;  ///< of the sketches, relative to the typical distance between cases
};

/// Pairs whose fields are the same, exactly or to within a small part of a case's usual distance to its
/// nearest. Repeated runs of one case (same inputs, another random start) lie much farther apart and are no
/// twins.
[[nodiscard]] std::vector<Twin> find_twins(std::span<const CaseSummary> cases);

struct Outlier {
  std::size_t i_case = 0;
  std::string field;    ///< which lies apart
  double distance = 0;  ///< relative to the usual distance
  double limit = 0;     ///< of that distance
};

/// Robust distances in a POD space of every field (ROBPCA's two distances, Hubert et al. 2005, on spherical
/// principal components, Locantore et al. 1999): within the space of the leading modes and orthogonal to it.
/// Nothing is told for fewer than ten cases.
[[nodiscard]] std::vector<Outlier> find_outliers(std::span<const CaseSummary> cases);

/// For every field and case the larger of the two distances,
/// each relative to its usual size, (n_fields, n_cases).
[[nodiscard]] MatrixD outlier_distances(std::span<const CaseSummary> cases);

}  // namespace elrom::ingest
