#include "elrom/networks/split.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace elrom::networks {
namespace {

constexpr std::size_t stratum_size = 10;

// Deals parts so that after every item each part is as near to
// its share as it can be (largest remainder first).
class Dealer {
 public:
  explicit Dealer(std::span<const double> fractions) : fractions_(fractions.begin(), fractions.end()) {}
  Part next() {
    ++dealt_;
    std::size_t best = 0;
    double largest = -1e300;
    for (std::size_t i = 0; i < fractions_.size(); ++i) {
      const double lack = fractions_[i] * static_cast<double>(dealt_) - static_cast<double>(count_[i]);
      if (fractions_[i] > 0 && lack > largest + 1e-9) best = i, largest = lack;
    }
    ++count_[best];
    return static_cast<Part>(best);
  }

 private:
  std::vector<double> fractions_;
  std::array<std::size_t, 3> count_{};
  std::size_t dealt_ = 0;
};

void give_every_part_one(std::vector<Part>& parts, std::span<const double> fractions) {
  for (const Part wanted : {Part::train, Part::validation, Part::test}) {
    const bool needed =
        fractions[static_cast<std::size_t>(wanted)] > 0 && (parts.size() > 2 || wanted != Part::test);
    if (!needed || std::ranges::count(parts, wanted) > 0) continue;
    for (const Part giver : {Part::train, Part::validation}) {
      if (std::ranges::count(parts, giver) < 2) continue;
      *std::ranges::find(parts, giver) = wanted;
      break;
    }
  }
}

std::vector<std::size_t> shuffled_strata(const std::vector<std::size_t>& order, base::Random& random) {
  std::vector<std::size_t> result;
  for (std::size_t begin = 0; begin < order.size(); begin += stratum_size) {
    const auto end = std::min(begin + stratum_size, order.size());
    std::vector<std::size_t> stratum(order.begin() + static_cast<std::ptrdiff_t>(begin),
                                     order.begin() + static_cast<std::ptrdiff_t>(end));
    random.shuffle(stratum);
    result.insert(result.end(), stratum.begin(), stratum.end());
  }
  return result;
}

/// Ordered by load and shuffled within strata.
std::vector<std::size_t> dealing_order(std::span<const double> loads, base::Seed seed) {
  const auto rank = [&](std::size_t i) { return std::isnan(loads[i]) ? HUGE_VAL : loads[i]; };
  std::vector<std::size_t> order(loads.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, rank);
  base::Random random(seed.derive("split"));
  return shuffled_strata(order, random);
}

std::vector<double> numbers(std::size_t n) {
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  return numbers;
}

/// @param deal parts of items with these ranks. By record its number stands for its load: strata are runs of
/// records, dealt out without regard to cases.
template <class Deal>
std::vector<Part> record_parts(std::span<const double> loads, std::size_t n_planes, const PartRule& rule,
                               const Deal& deal) {
  if (rule.by == "record") return deal(numbers(loads.size() * n_planes));
  const std::vector<Part> cases = deal(std::vector<double>(loads.begin(), loads.end()));
  std::vector<Part> records(loads.size() * n_planes);
  for (std::size_t r = 0; r < records.size(); ++r) records[r] = cases[r / n_planes];
  return records;
}

}  // namespace

std::vector<Part> split_cases(std::span<const double> loads, std::span<const double> fractions,
                              base::Seed seed) {
  Dealer dealer(fractions);
  std::vector<Part> parts(loads.size());
  for (const auto i : dealing_order(loads, seed)) parts[i] = dealer.next();
  give_every_part_one(parts, fractions);
  return parts;
}

std::vector<Part> split_records(std::span<const double> loads, std::size_t n_planes, const PartRule& rule,
                                base::Seed seed) {
  return record_parts(loads, n_planes, rule, [&](const std::vector<double>& ranks) {
    return split_cases(ranks, rule.fractions, seed);
  });
}

std::vector<Part> build_parts(std::span<const double> loads, std::size_t n_planes, const PartRule& rule,
                              base::Seed seed, BuildNumber number) {
  const double share = rule.fractions[static_cast<std::size_t>(Part::validation)];
  return record_parts(loads, n_planes, rule, [&](const std::vector<double>& ranks) {
    std::vector<Part> parts(ranks.size(), Part::train);
    if (!(share > 0) || ranks.size() < 2) return parts;
    const auto least = static_cast<std::size_t>(std::ceil(1 / share - 1e-9));
    const auto n_folds = std::min(std::max({number.n_builds, least, std::size_t{2}}), ranks.size());
    const auto order = dealing_order(ranks, seed);
    for (std::size_t k = 0; k < order.size(); ++k)
      if (k % n_folds == number.i_build % n_folds) parts[order[k]] = Part::validation;
    return parts;
  });
}

}  // namespace elrom::networks
