#pragma once
// Stores of any size with the shape of real ones, for benchmarks and tests of size and speed. Never for
// claims of accuracy.
//
// Inputs: a Latin hypercube over load and every input's own deviation; load drives all flows together.
// Fields, with s = 0 in the middle of a cross-section and 1 at its walls:
//   gas upward velocity   flow entered below / (density at the case's temperature x area), flat core, slow
//                         at walls
//   solids upward         gas less the terminal velocity of d50, falling along the walls (core and annulus)
//   volume fraction       dense bed, then exponential decay towards a dilute limit; denser at walls; scaled
//                         so that the weight of solids is the case's inventory
//   pressure              weight of solids and gas above, zero at the outlet
//   lateral velocities    jets of the inlets at their places, and solids drifting to the walls
//   diameter              d50, coarser in the bed, finer above
//   further fields        "tracer_NN": mixing of one inlet's gas with the rest
// To each, smooth waves and white noise are added, so that repeated cases would differ as averaged CFD does.

#include <cstdint>
#include <filesystem>
#include <stop_token>

#include "elrom/base/log.hpp"

namespace elrom::ingest {

struct GenerateOptions {
  std::filesystem::path store;  ///< must not exist
  std::size_t n_cases = 249;    ///< train_000 ...
  std::size_t n_held_out = 0;   ///< load_042 ..., evenly spread loads, beside the n_cases
  std::size_t n_planes = 66, n_columns = 840;
  std::size_t n_fields = 9;   ///< fewer: the first of the standard fields; more: tracers
  std::size_t n_inputs = 26;  ///< fewer: the first of the shipped cases' inputs; more: auxiliary inlets
  double noise = 0.1;         ///< of a field's scale
  std::uint64_t seed = 1;
  int n_threads = 1;
};

/// The same options give the same bytes for any n_threads. Memory: a few cases at a time.
/// @throws UsageError for impossible sizes or a store that exists, Interrupted
void generate(const GenerateOptions& options, Log& log, const std::stop_token& stop = {});

}  // namespace elrom::ingest
