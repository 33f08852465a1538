#pragma once
// The peers that every accuracy report shows beside the networks, as a user would run them: no mirror images,
// inputs standardised one by one, POD of the snapshots as they are.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/math/pod.hpp"
#include "elrom/math/rbf.hpp"
#include "elrom/methods/catalogue.hpp"
#include "elrom/methods/method.hpp"

namespace elrom::methods {

struct PeerOptions {
  math::PodTruncation truncation{.n_modes = 15, .energy = 1};
  math::RbfOptions rbf{.function = math::RadialFunction::linear, .smoothing = 1, .degree = -1};
  std::vector<double> gp_start_lengths{5.0};  ///< starts of the likelihood's search, in standard deviations
  int gp_iterations = 100;
};

/// fit() of a peer may run on several threads at a time.
/// @param name one of peer_names(). @throws UsageError for an unknown name, with the nearest one
[[nodiscard]] std::unique_ptr<Method> make_peer(std::string_view name, const PeerOptions& options = {});

}  // namespace elrom::methods
