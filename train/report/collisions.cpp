#include "elrom/report/collisions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/particle/balance.hpp"

namespace elrom::report {
namespace {

using particle::CollisionBundle;
using particle::CollisionSet;
using particle::Components;
using particle::Scalars;

std::vector<std::string> differences(const CollisionBundle& bundle, const CollisionSet& set) {
  std::vector<std::string> found;
  const auto note = [&](bool differs, const char* what) {
    if (differs) found.emplace_back(what);
  };
  const auto &a = bundle.protocol, &b = set.protocol;
  note(bundle.law != set.law, "contact law");
  note(a.kind != b.kind, "protocol");
  note(a.speed != b.speed, "speeds");
  note(a.diameter_1 != b.diameter_1 || a.diameter_2 != b.diameter_2, "diameters");
  note(a.density_1 != b.density_1 || a.density_2 != b.density_2, "densities");
  note(a.spin_speed != b.spin_speed, "spins");
  note(a.approach_time != b.approach_time, "approach time");
  return found;
}

std::optional<double> training_seconds(const CollisionBundle& bundle) {
  const auto found = bundle.provenance.find("training_s");
  return found == bundle.provenance.end() ? std::nullopt : base::to_double(found->second);
}

std::vector<double> equal_bins(double high, std::size_t n) {
  std::vector<double> edges;
  for (std::size_t i = 0; i <= n; ++i)
    edges.push_back(high * static_cast<double>(i) / static_cast<double>(n));
  return edges;
}

// Mean of `values` of the pairs whose `place` lies in each bin.
std::vector<double> means_by(const Scalars& place, const std::vector<double>& edges, const Scalars& values) {
  std::vector<double> sums(edges.size() - 1), counts(sums.size());
  for (Eigen::Index i = 0; i < place.size(); ++i) {
    const double share = place[i] / edges.back() * static_cast<double>(sums.size());
    if (!(share >= 0)) continue;
    const auto bin = std::min(sums.size() - 1, static_cast<std::size_t>(share));
    sums[bin] += values[i];
    ++counts[bin];
  }
  for (std::size_t i = 0; i < sums.size(); ++i)
    sums[i] = counts[i] > 0 ? sums[i] / counts[i] : std::numeric_limits<double>::quiet_NaN();
  return sums;
}

/// The pairs that judge.
struct Judged {
  particle::Pairs pairs;
  particle::Motion truth;
  Scalars angle, speed;
  double fastest;  ///< component after, m/s
};

Judged judged_pairs(const CollisionSet& set, std::size_t first, std::size_t count) {
  Judged judged{.pairs = slice(set.pairs, first, count), .truth = slice(set.parting.after, first, count)};
  judged.angle = impact_angles(judged.pairs);
  judged.speed = particle::lengths(judged.pairs.before.velocity_1 - judged.pairs.before.velocity_2);
  judged.fastest =
      std::max(judged.truth.velocity_1.abs().maxCoeff(), judged.truth.velocity_2.abs().maxCoeff());
  return judged;
}

CollisionFigures figures_of(const particle::CollisionModel& model, const Judged& judged,
                            const CollisionReport& report) {
  constexpr std::size_t n_bins = 48;
  const auto after = motion_after(model, judged.pairs);
  CollisionFigures figures;
  for (int k = 0; k < 3; ++k) {
    ParityMap map(-judged.fastest, judged.fastest, n_bins);
    for (Eigen::Index i = 0; i < after.velocity_1.rows(); ++i) {
      map.add(judged.truth.velocity_1(i, k), after.velocity_1(i, k));
      map.add(judged.truth.velocity_2(i, k), after.velocity_2(i, k));
    }
    figures.parity[static_cast<std::size_t>(k)] = std::move(map);
  }
  figures.relative = Histogram(-8, 1, 36);
  for (const double error : relative_errors(after, judged.truth))
    figures.relative.add(std::log10(std::max(error, 1e-300)));
  const Components error_1 = (after.velocity_1 - judged.truth.velocity_1).abs(),
                   error_2 = (after.velocity_2 - judged.truth.velocity_2).abs();
  const Scalars error = 0.5 * (error_1.rowwise().mean() + error_2.rowwise().mean());
  figures.by_angle = means_by(judged.angle, report.angle_edges, error);
  figures.by_speed = means_by(judged.speed, report.speed_edges, error);
  return figures;
}

bool beats(const CollisionModelReport& a, const CollisionModelReport& b) {
  const double error_a = a.errors.mae_velocity, error_b = b.errors.mae_velocity;
  return error_a <= error_b && a.call_seconds <= b.call_seconds &&
         (error_a < error_b || a.call_seconds < b.call_seconds);
}

void mark_front(std::vector<CollisionModelReport>& models) {
  for (auto& model : models)
    model.front = std::none_of(models.begin(), models.end(),
                               [&](const CollisionModelReport& other) { return beats(other, model); });
}

// "document, 690 trees, slow pairs (to 2 m/s) apart": what
// stands in tables and beside points is its first two parts.
std::string short_text(const particle::CollisionModel& model) {
  const auto parts = base::split(model.text(), ',');
  return parts.size() < 2 ? model.text() : parts[0] + "," + parts[1];
}

// Two of one kind are told apart by their files.
void name_models(std::vector<CollisionModelReport>& models, const std::vector<CollisionBundle>& bundles) {
  for (std::size_t i = 0; i < models.size(); ++i) {
    models[i].name = short_text(*bundles[i].model);
    const auto alike = std::count_if(bundles.begin(), bundles.end(), [&](const CollisionBundle& other) {
      return short_text(*other.model) == models[i].name;
    });
    if (alike > 1) models[i].name += " (" + models[i].file.filename().string() + ")";
  }
}

}  // namespace

CollisionReport collision_report(const CollisionReportOptions& options, Log& log,
                                 const std::stop_token& stop) {
  if (options.models.empty()) throw UsageError("no collision model to report on; name at least one");
  const auto set = particle::read_collisions(options.set);
  if (set.size() == 0)
    throw InputError(Problem{.what = "a set without collisions", .where = options.set.string()});
  CollisionReport report{.set = options.set,
                         .digest = base::sha256_file(options.set),
                         .protocol = set.protocol,
                         .law = set.law,
                         .seed = set.seed,
                         .speed_cap = set.speed_cap,
                         .summary = summarise(set)};
  std::vector<CollisionBundle> bundles;
  bool one_learned = false;
  for (const auto& path : options.models) {
    bundles.push_back(CollisionBundle::read(path));
    const auto& bundle = bundles.back();
    const auto source = bundle.provenance.find("collisions");
    const bool learned = source != bundle.provenance.end() && source->second == report.digest;
    report.models.push_back({.file = path,
                             .kind = bundle.model->kind(),
                             .differs = differences(bundle, set),
                             .learned_from_set = learned,
                             .training_seconds = training_seconds(bundle)});
    one_learned = one_learned || learned;
  }
  name_models(report.models, bundles);
  report.n_judged = one_learned ? particle::n_test_pairs(set.size()) : set.size();
  const auto first = set.size() - report.n_judged;
  const auto judged = judged_pairs(set, first, report.n_judged);
  report.angle_edges = equal_bins(90, 15);
  report.speed_edges = equal_bins(std::max(judged.speed.maxCoeff(), 1e-300), 12);
  for (std::size_t i = 0; i < bundles.size(); ++i) {
    if (stop.stop_requested()) throw Interrupted("elrom-report collisions");
    auto& model = report.models[i];
    log.info("judging " + model.name);
    model.errors = errors_of(*bundles[i].model, set, first, report.n_judged);
    model.figures = figures_of(*bundles[i].model, judged, report);
    model.call_seconds = seconds_a_call(*bundles[i].model, judged.pairs, options.n_calls);
  }
  mark_front(report.models);
  return report;
}

}  // namespace elrom::report
