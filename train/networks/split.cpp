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

}  // namespace

std::vector<Part> split_cases(std::span<const double> loads, std::span<const double> fractions,
                              base::Seed seed) {
  const auto rank = [&](std::size_t i) { return std::isnan(loads[i]) ? HUGE_VAL : loads[i]; };
  std::vector<std::size_t> order(loads.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, rank);
  base::Random random(seed.derive("split"));
  Dealer dealer(fractions);
  std::vector<Part> parts(loads.size());
  for (const auto i : shuffled_strata(order, random)) parts[i] = dealer.next();
  give_every_part_one(parts, fractions);
  return parts;
}

std::vector<Part> split_records(std::span<const double> loads, std::size_t n_planes, const PartRule& rule,
                                base::Seed seed) {
  std::vector<Part> records(loads.size() * n_planes);
  if (rule.by == "record") {
    // The record's number stands for its load: strata are runs of records, dealt out without regard to cases.
    std::vector<double> rank(records.size());
    std::iota(rank.begin(), rank.end(), 0.0);
    return split_cases(rank, rule.fractions, seed);
  }
  const auto cases = split_cases(loads, rule.fractions, seed);
  for (std::size_t r = 0; r < records.size(); ++r) records[r] = cases[r / n_planes];
  return records;
}

}  // namespace elrom::networks
