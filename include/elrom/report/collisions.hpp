#pragma once
// Learned collision models beside each other on one set of collisions: errors, balances, cost.

#include <array>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/particle/collision_errors.hpp"
#include "elrom/particle/collision_summary.hpp"
#include "elrom/report/figures.hpp"

namespace elrom::report {

/// Mean absolute errors of u, v, w that the source prints of its surrogate, m/s.
struct SourceMae {
  double diameter;  ///< m
  std::array<double, 3> mae;
};
inline constexpr std::array source_mae{SourceMae{315e-6, {0.5877, 0.5802, 0.5531}},
                                       SourceMae{475e-6, {0.7078, 0.7276, 0.6078}}};

struct CollisionReportOptions {
  std::filesystem::path set;
  std::vector<std::filesystem::path> models;
  std::size_t n_calls = 1'000'000;  ///< that speed is measured by
};

/// What the page draws of one model.
struct CollisionFigures {
  std::array<ParityMap, 3> parity;  ///< u, v, w of both spheres, m/s
  Histogram relative;               ///< log10 of |error of the velocity| / |velocity after|
  std::vector<double> by_angle,
      by_speed;  ///< mean |error of a velocity component| in each bin; NaN: no pairs
};

struct CollisionModelReport {
  std::string name;  ///< "frame, chebyshev"; with its file where two are alike
  std::filesystem::path file;
  particle::SurrogateKind kind = particle::SurrogateKind::frame;
  /// What it was learned for and the set is not: "contact law", "diameters" ... Its errors then say little.
  std::vector<std::string> differs;
  bool learned_from_set = false;
  particle::CollisionErrors errors;
  std::optional<double> training_seconds;
  double call_seconds = 0;  ///< of one core
  bool front = false;       ///< no other is at least as near and as fast, and better in one
  CollisionFigures figures;
};

struct CollisionReport {
  std::filesystem::path set;
  std::string digest;
  particle::Protocol protocol;
  particle::ContactLaw law;
  std::uint64_t seed = 1;
  std::optional<double> speed_cap;
  particle::CollisionSummary summary;
  /// The last pairs judge where a model learned from this set's others; all of them where none did.
  std::size_t n_judged = 0;
  std::vector<double> angle_edges, speed_edges;  ///< degrees, m/s, of the bins
  std::vector<CollisionModelReport> models;

  [[nodiscard]] bool judges_all() const { return n_judged == summary.n_pairs; }
};

/// @throws InputError for files that cannot be read; UsageError without a model; Interrupted
[[nodiscard]] CollisionReport collision_report(const CollisionReportOptions& options, Log& log,
                                               const std::stop_token& stop = {});

/// The nearest model in words, and which figures mislead.
[[nodiscard]] std::string headline(const CollisionReport& report);
/// What accuracy costs, in a sentence.
[[nodiscard]] std::string cost_sentence(const CollisionReport& report);
/// What the set is, a sentence each.
[[nodiscard]] std::vector<std::string> set_sentences(const CollisionReport& report);

[[nodiscard]] std::string terminal_table(const CollisionReport& report);
[[nodiscard]] std::string to_json(const CollisionReport& report);
/// One HTML file that opens offline.
[[nodiscard]] std::string html_page(const CollisionReport& report);

}  // namespace elrom::report
