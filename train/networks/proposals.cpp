#include "proposals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <nlopt.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::networks {
namespace {

constexpr int calls_a_trial = 60;     // points that decode to known trials cost nothing; but not without end
constexpr double sobol_share = 0.35;  // of the trials, before BOBYQA starts
constexpr std::size_t n_starts = 3;   // best Sobol points that BOBYQA starts from
constexpr unsigned crs2_population = 10;
constexpr double worst = 1e30;  // finite: infinities upset several algorithms

// NLopt's objective around Ask: nothing may leave it as an exception, because some algorithms go on calling
// after one.
struct Bridge {
  const Ask* ask;
  std::exception_ptr failure;
  nlopt::opt* optimiser;

  static double call(const std::vector<double>& x, std::vector<double>&, void* data) {
    auto& self = *static_cast<Bridge*>(data);
    if (self.failure) return worst;
    try {
      return (*self.ask)(x);
    } catch (...) {
      self.failure = std::current_exception();
      self.optimiser->force_stop();
      return worst;
    }
  }
};

void minimise(nlopt::opt& optimiser, std::vector<double> start, int max_calls, base::Seed seed,
              const Ask& ask) {
  const auto n = optimiser.get_dimension();
  Bridge bridge{&ask, nullptr, &optimiser};
  optimiser.set_lower_bounds(std::vector<double>(n, 0.0));
  optimiser.set_upper_bounds(std::vector<double>(n, 1.0));
  optimiser.set_min_objective(&Bridge::call, &bridge);
  optimiser.set_maxeval(max_calls);
  nlopt::srand(static_cast<unsigned long>(seed.value()));
  try {
    double value = 0;
    optimiser.optimize(start, value);
  } catch (const std::exception&) {
    // Forced stop, or rounding limits reached: what counts is in
    // the trials; an error of Ask is thrown again below.
  }
  if (bridge.failure) std::rethrow_exception(bridge.failure);
}

void local(nlopt::algorithm algorithm, const std::vector<double>& start, const std::vector<double>& step,
           int max_calls, base::Seed seed, const Ask& ask) {
  nlopt::opt optimiser(algorithm, static_cast<unsigned>(start.size()));
  optimiser.set_initial_step(step);
  optimiser.set_xtol_abs(1e-3);
  minimise(optimiser, start, max_calls, seed, ask);
}

void global(nlopt::algorithm algorithm, std::size_t n_dimensions, int max_calls, base::Seed seed,
            const Ask& ask) {
  nlopt::opt optimiser(algorithm, static_cast<unsigned>(n_dimensions));
  if (algorithm == nlopt::GN_CRS2_LM) optimiser.set_population(crs2_population);
  minimise(optimiser, std::vector<double>(n_dimensions, 0.5), max_calls, seed, ask);
}

std::vector<double> random_point(std::size_t n, base::Random& random) {
  std::vector<double> point(n);
  for (auto& x : point) x = random.uniform();
  return point;
}

void random_points(std::size_t n_dimensions, std::size_t n_calls, base::Random& random, const Ask& ask) {
  for (std::size_t i = 0; i < n_calls; ++i) (void)ask(random_point(n_dimensions, random));
}

void sobol_then_bobyqa(std::size_t n_dimensions, const std::vector<double>& step, std::size_t n_trials,
                       base::Seed seed, const Ask& ask) {
  base::Random random(seed);
  const auto shift = random_point(n_dimensions, random);
  const auto n_sobol = std::max<std::size_t>(
      2, static_cast<std::size_t>(std::ceil(sobol_share * static_cast<double>(n_trials))));
  std::vector<std::pair<double, std::vector<double>>> seen;
  for (std::size_t i = 0; i < n_sobol; ++i) {
    auto point = sobol_point(i, shift);
    const double value = ask(point);
    seen.emplace_back(value, std::move(point));
  }
  std::ranges::stable_sort(seen, {}, [](const auto& entry) { return entry.first; });
  const auto calls = static_cast<int>((n_trials - std::min(n_trials, n_sobol)) / n_starts) +
                     static_cast<int>(2 * n_dimensions) + 1;
  for (std::size_t k = 0; k < std::min(n_starts, seen.size()); ++k) {
    local(nlopt::LN_BOBYQA, seen[k].second, step, calls, seed, ask);
  }
}

}  // namespace

std::vector<double> sobol_point(std::size_t i, std::span<const double> shift) {
  struct Direction {
    unsigned degree, polynomial;
    std::array<unsigned, 4> m;
  };
  static constexpr std::array<Direction, 5> directions{
      {{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}}}};
  check(shift.size() <= directions.size() + 1, "sobol_point: at most 6 dimensions");
  const std::size_t gray = i ^ (i >> 1);
  std::vector<double> point(shift.size());
  for (std::size_t d = 0; d < shift.size(); ++d) {
    std::array<std::uint32_t, 32> v{};
    for (unsigned b = 0; b < 32; ++b) {
      if (d == 0) {
        v[b] = 1U << (31 - b);
        continue;
      }
      const auto& [s, a, m] = directions[d - 1];
      if (b < s) {
        v[b] = m[b] << (31 - b);
        continue;
      }
      v[b] = v[b - s] ^ (v[b - s] >> s);
      for (unsigned k = 1; k < s; ++k) v[b] ^= ((a >> (s - 1 - k)) & 1U) * v[b - k];
    }
    std::uint32_t bits = 0;
    for (unsigned b = 0; b < 32; ++b)
      if (((gray >> b) & 1U) != 0) bits ^= v[b];
    const double x = bits * 0x1.0p-32 + shift[d];
    point[d] = x - std::floor(x);
  }
  return point;
}

void propose(const std::string& algorithm, std::size_t n_dimensions, const std::vector<double>& initial_step,
             std::size_t n_trials, base::Seed seed, const Ask& ask) {
  const int max_calls = static_cast<int>(n_trials) * calls_a_trial;
  base::Random random(seed.derive("random"));
  try {
    if (algorithm == "direct")
      global(nlopt::GN_DIRECT, n_dimensions, max_calls, seed, ask);
    else if (algorithm == "crs2")
      global(nlopt::GN_CRS2_LM, n_dimensions, max_calls, seed, ask);
    else if (algorithm == "sbplx")
      local(nlopt::LN_SBPLX, std::vector<double>(n_dimensions, 0.5), initial_step, max_calls, seed, ask);
    else if (algorithm == "sobol_bobyqa")
      sobol_then_bobyqa(n_dimensions, initial_step, n_trials, seed, ask);
    else if (algorithm != "random") {
      const std::vector<std::string> known{"direct", "sobol_bobyqa", "sbplx", "crs2", "random"};
      throw UsageError({.what = "unknown search.algorithm '" + algorithm + "'",
                        .advice = base::name_advice(algorithm, known)});
    }
    // A local algorithm may converge with trials to spare; they are spent at random.
    random_points(n_dimensions, static_cast<std::size_t>(max_calls), random, ask);
  } catch (const SearchEnded&) {
  }
}

}  // namespace elrom::networks
