#include "elrom/particle/collision_errors.hpp"

#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/particle/balance.hpp"

namespace elrom::particle {
namespace {

Components difference_1(const Motion& a, const Motion& b) { return a.velocity_1 - b.velocity_1; }
Components difference_2(const Motion& a, const Motion& b) { return a.velocity_2 - b.velocity_2; }

// Mean of |r w - r w_true|, components of both spheres.
double surface_error(const Pairs& pairs, const Motion& model, const Motion& truth) {
  const Components one = (model.spin_1 - truth.spin_1).colwise() * (0.5 * pairs.diameter_1),
                   two = (model.spin_2 - truth.spin_2).colwise() * (0.5 * pairs.diameter_2);
  return 0.5 * (one.abs().mean() + two.abs().mean());
}

double thread_seconds() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

Motion motion_after(const CollisionModel& model, const Pairs& pairs) {
  Impulses impulses;
  model.impulses(pairs, impulses);
  return apply(pairs, impulses);
}

std::vector<double> relative_errors(const Motion& model, const Motion& truth) {
  std::vector<double> result;
  const auto add = [&](const Scalars& error, const Scalars& speed) {
    for (Eigen::Index i = 0; i < speed.size(); ++i)
      if (speed[i] > 0) result.push_back(error[i] / speed[i]);
  };
  add(lengths(difference_1(model, truth)), lengths(truth.velocity_1));
  add(lengths(difference_2(model, truth)), lengths(truth.velocity_2));
  return result;
}

CollisionErrors errors_of(const CollisionModel& model, const CollisionSet& set, std::size_t first,
                          std::size_t count) {
  check(count > 0 && first + count <= set.size(), "errors_of: pairs within the set");
  const auto pairs = slice(set.pairs, first, count);
  const auto truth = slice(set.parting.after, first, count);
  const auto after = motion_after(model, pairs);
  const Components error_1 = difference_1(after, truth).abs(), error_2 = difference_2(after, truth).abs();
  CollisionErrors errors{.n_pairs = count};
  for (int k = 0; k < 3; ++k)
    errors.mae[static_cast<std::size_t>(k)] = 0.5 * (error_1.col(k).mean() + error_2.col(k).mean());
  errors.mae_velocity = (errors.mae[0] + errors.mae[1] + errors.mae[2]) / 3;
  errors.mae_surface = surface_error(pairs, after, truth);
  errors.greatest = std::max(error_1.maxCoeff(), error_2.maxCoeff());
  const auto relative = relative_errors(after, truth);
  constexpr std::array shares{0.1, 0.5, 0.9, 0.99};
  for (std::size_t k = 0; k < shares.size(); ++k)
    errors.relative[k] = relative.empty() ? 0 : math::quantile(relative, shares[k]);
  const auto momentum = momentum_errors(pairs, after), gained = energy_changes(pairs, after);
  errors.momentum_error = momentum.maxCoeff();
  errors.mean_momentum_error = momentum.mean();
  errors.energy_gain = std::max(0.0, gained.maxCoeff());
  errors.gaining_share =
      static_cast<double>((gained > CollisionErrors::gain_from).count()) / static_cast<double>(count);
  const double energy = kinetic_energy(pairs, pairs.before).sum();
  if (energy > 0) {
    errors.energy_lost = 1 - kinetic_energy(pairs, after).sum() / energy;
    errors.energy_lost_truth = 1 - kinetic_energy(pairs, truth).sum() / energy;
  }
  return errors;
}

double seconds_a_call(const CollisionModel& model, const Pairs& pairs, std::size_t n_calls) {
  check(pairs.size() > 0, "seconds_a_call: at least one pair");
  constexpr std::size_t block = 1024;  // stays in the processor's cache
  constexpr int n_runs = 5;
  std::vector<Pairs> blocks;
  for (std::size_t first = 0; first < pairs.size() && blocks.size() < 16; first += block)
    blocks.push_back(slice(pairs, first, std::min(block, pairs.size() - first)));
  Impulses impulses;
  for (const auto& some : blocks) model.impulses(some, impulses);  // memory and caches
  double best = std::numeric_limits<double>::infinity();
  for (int run = 0; run < n_runs; ++run) {
    std::size_t done = 0;
    const double begin = thread_seconds();
    for (std::size_t i = 0; done < std::max<std::size_t>(1, n_calls / n_runs); ++i) {
      model.impulses(blocks[i % blocks.size()], impulses);
      done += blocks[i % blocks.size()].size();
    }
    best = std::min(best, (thread_seconds() - begin) / static_cast<double>(done));
  }
  return best;
}

std::string to_json(const CollisionErrors& errors) {
  const nlohmann::ordered_json json{{"n_pairs", errors.n_pairs},
                                    {"mae_m_per_s", errors.mae},
                                    {"mae_velocity_m_per_s", errors.mae_velocity},
                                    {"mae_surface_m_per_s", errors.mae_surface},
                                    {"greatest_m_per_s", errors.greatest},
                                    {"relative_10_50_90_99", errors.relative},
                                    {"momentum_error", errors.momentum_error},
                                    {"mean_momentum_error", errors.mean_momentum_error},
                                    {"energy_gain", errors.energy_gain},
                                    {"gaining_share", errors.gaining_share},
                                    {"energy_lost", errors.energy_lost},
                                    {"energy_lost_truth", errors.energy_lost_truth}};
  return json.dump();
}

}  // namespace elrom::particle
