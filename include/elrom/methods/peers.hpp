#pragma once
// The peers that every accuracy report shows beside the networks, each at full strength and as a user would
// run it: no mirror images, inputs standardised one by one, POD of the snapshots as they are.
//
// What a peer may choose it chooses on its training cases, by these rules. "Error" is the squared error of
// coefficients of cases left out, in closed form (Allen 1974; Rippa 1999; Rasmussen & Williams 2006, eqs.
// 5.10 to 5.12), summed over cases; of a mode that is not kept it is the mode's energy.
//   modes             the first n that leave the least error, at most `most_modes`
//   linear            ridge, a penalty for each mode: the least error
//   pod_rbf           smoothing for each mode: the least error; function and degree of the tail, shared by
// all
//                     modes: the least error (linear, with a constant or a linear tail; thin plate; cubic)
//   pod_gp            one covariance for all modes. Lengths and noise: the least error of the field
//                     (Sundararajan & Keerthi 2001), not the likelihood, in which modes that are nothing but
//                     noise count as much as those that matter. One length scale for all inputs (from each of
//                     `gp_start_lengths`), or one each where Schwarz's (1978) criterion of those errors says
//                     so. Covariance (Matern 3/2, Matern 5/2, Gaussian): the least error
//   pod_gp_per_mode   length scales, signal and noise by likelihood, with one length scale for all inputs (of
//                     `gp_start_lengths` the best) and with one each (from where that ended, and from the
//                     first and the last of them): the least information criterion (Schwarz 1978).
//                     Covariance, shared by all modes: the least error of the first `covariance_modes`. In
//                     blocks of modes, until one gains nothing
// pod_mlp, which needs a trainer, has a header of its own.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/methods/catalogue.hpp"
#include "elrom/methods/method.hpp"

namespace elrom::methods {

struct PeerOptions {
  std::size_t most_modes = 60;
  int mode_block = 5;         ///< modes of pod_gp_per_mode that are tried at a time
  int covariance_modes = 4;   ///< a covariance is chosen by so many modes of pod_gp_per_mode
  int smoothing_decades = 8;  ///< RBF smoothing: 0, and from 10^-decades to 10^2 by factors of 10
  /// Of the searches, in standard deviations. The last start hardly leaves room for noise: beside the optimum
  /// of a smooth mode there is another one that takes its fine structure for noise, and the way into it from
  /// any noise worth the name.
  std::vector<double> gp_start_lengths{5.0, 1.5, 5.0};
  std::vector<double> gp_start_noises{0.1, 1e-3, 1e-6};  ///< one for each start
  int gp_iterations = 100;
};

/// fit() of a peer may run on several threads at a time.
/// @param name one of closed_form_peers(). @throws UsageError for an unknown name, with the nearest one
[[nodiscard]] std::unique_ptr<Method> make_peer(std::string_view name, const PeerOptions& options = {});

}  // namespace elrom::methods
