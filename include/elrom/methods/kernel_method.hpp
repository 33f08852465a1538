#pragma once
// Method "kernel": kernel smoothers on derived inputs, for the symmetric and each antisymmetric part of a
// field and each zone of height on its own. Hyperparameters, and how far every wavelength and every cell is
// trusted, minimise the leave-one-case-out error in closed form (Allen 1974; Craven & Wahba 1979 for linear
// smoothers). So do the covariance (Matern 5/2 or Gaussian) and the form in which an input enters that varies
// by more than a factor of two (itself, logarithm, inverse).
//
// Much of what differs from case to case is how large the field is: gas velocities grow as the gas flow,
// the pressure as the inventory, the diameter as the solids' own. So a field is learned over a scale, a
// product of powers of such quantities; the exponents are those of the least leave-one-out error, near 0 a
// priori (normal, deviation 0.6), taken where cases gain by it more than a standard error.
//
// One noise for all that a field does smooths its leading modes too much, and the rest too little: the
// leading modes of what the smoother says have lengths and noise of their own, by likelihood near those of
// the field.
//
// A furnace is one thing at its bottom and another at its top: each zone of height has a smoother and modes
// of its own, and a cell between two zones is answered by both.
//
// An antisymmetric part follows the imbalances of the inputs, so a mirrored case gets the mirrored field. But
// where cases show beyond chance that one side differs from the other whatever the inputs (an outlet, or
// the solver), that lasting asymmetry is learned too.
//
// Why it does better than POD with a process a mode on few cases: mirror images are
// used exactly instead of by augmentation; all modes share one covariance with few,
// physical inputs; noise that no input explains is shrunk.

#include <memory>

#include "elrom/methods/method.hpp"

namespace elrom::methods {

struct KernelOptions {
  /// Energy that truncating the modes of a part may drop, as a share of the error's energy
  double dropped = 2e-3;
  std::size_t most_modes = 80;  ///< for the symmetric part; an antisymmetric part has at most a quarter of it
  std::size_t own_modes = 4;    ///< leading modes of a zone with lengths and noise of their own
  std::size_t zones = 3;        ///< of height, each with a smoother of its own; they fade into each other
  int passes = 2;         ///< searches; from the second on, errors are weighted by what the first one trusts
  bool scale = true;      ///< learn the field over a scale that the inputs give
  bool symmetric = true;  ///< false: the asymmetry alone, about zero
  bool antisymmetric = true;  ///< learn the antisymmetric parts too, instead of predicting none
  bool shrink = true;         ///< spectral and cell-wise shrinkage
};

/// fit() may run on several threads at a time.
[[nodiscard]] std::unique_ptr<Method> make_kernel_method(const KernelOptions& options = {});

}  // namespace elrom::methods
