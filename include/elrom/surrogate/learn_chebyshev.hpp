#pragma once
// Fits a Chebyshev regressor to records of collisions: least squares on panels of the angle of impact, which
// are halved where the error is greatest (friction changes from sliding to sticking at some angle).

#include <memory>

#include "elrom/particle/chebyshev.hpp"
#include "elrom/particle/frame_model.hpp"

namespace elrom::surrogate {

struct ChebyshevSettings {
  int degree_x = 3, degree_y = 3;
  int most_panels = 24;
  /// A panel is halved only while each half keeps this many records a term.
  double records_a_term = 3;
  bool operator==(const ChebyshevSettings&) const = default;
};

/// Records weigh by their speed: what counts is the error of velocities, not of shares.
/// @throws InputError for too few records to fit one panel
[[nodiscard]] std::unique_ptr<particle::Chebyshev> learn_chebyshev(const particle::FrameRecords& records,
                                                                   const ChebyshevSettings& settings = {});

}  // namespace elrom::surrogate
