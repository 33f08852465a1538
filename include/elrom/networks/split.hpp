#pragma once
// Which records are learned from, which stop the learning, which judge it: 70 / 20 / 10 % of the cases that
// are not held out. Screening and search go by these; the builds of a band stop on a fold of cases each, so
// that all cases build some of them. By case the planes of one case stay together; by record they do not,
// which leaks and exists to show that it does.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/networks/settings.hpp"

namespace elrom::networks {

enum class Part : std::uint8_t { train, validation, test };

/// Part of every case: cases are ordered by load and dealt out stratum by stratum, so that each part spans
/// the loads. Every part that has a fraction above 0 gets a case where there are at least three; with two,
/// one of them both stops and judges (Part::validation). NaN loads come last.
[[nodiscard]] std::vector<Part> split_cases(std::span<const double> loads, std::span<const double> fractions,
                                            base::Seed seed);

/// How the cases that are not held out are dealt out.
struct PartRule {
  std::string by = "case";
  std::vector<double> fractions = SplitSettings{}.fractions;
};
[[nodiscard]] inline PartRule part_rule(const SplitSettings& settings) {
  return {settings.by, settings.fractions};
}

/// Part of every record, (n_cases * n_planes), case by case.
[[nodiscard]] std::vector<Part> split_records(std::span<const double> loads, std::size_t n_planes,
                                              const PartRule& rule, base::Seed seed);

/// One of a band's builds.
struct BuildNumber {
  std::size_t i_build = 0, n_builds = 1;
};
/// Part of every record in one of several builds: each stops on a fold of its own, dealt out as above, and
/// learns from all other records. As many folds as builds, but none larger than the rule's validation part;
/// no fold where the rule has no such part or there is one case (record) alone.
[[nodiscard]] std::vector<Part> build_parts(std::span<const double> loads, std::size_t n_planes,
                                            const PartRule& rule, base::Seed seed, BuildNumber number);

}  // namespace elrom::networks
