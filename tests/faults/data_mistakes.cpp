#include <filesystem>

#include "../../data/ingest/unit_mistakes.hpp"
#include "../stability/stages.hpp"
#include "campaign.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/ingest/check.hpp"

namespace elrom::faults {
namespace {

using ingest::CaseSummary;
using ingest::Correction;

/// The case as it reads when the mistake was made that `correction` undoes.
CaseSummary with_mistake(const CaseSummary& good, const Correction& correction) {
  auto bad = good;
  for (const auto i : correction.inputs)
    bad.inputs[i] = (bad.inputs[i] - correction.offset) / correction.factor;
  for (std::size_t m = 0; m < ingest::n_measures; ++m) {
    for (const auto& field : correction.fields) {
      if (ingest::field_of(static_cast<ingest::Measure>(m)) == field) bad.measures[m] /= correction.factor;
    }
  }
  return bad;
}

}  // namespace

Tally unit_mistakes(const Workshop& shop) {
  ingest::Checker checker;
  for (const auto& entry : std::filesystem::directory_iterator(shop.source / "data" / "cases")) {
    if (entry.path().extension() == ".h5") checker.add(ingest::view_of(ingest::read_el3d(entry.path())));
  }
  auto cases = checker.cases();
  Tally tally;
  for (const auto& mistake : ingest::find_unit_mistakes(cases)) {
    tally.count(false, "false alarm: " + cases[mistake.i_case].name + " " + mistake.quantity);
  }
  const auto corrections = ingest::possible_corrections(cases[0].schema, cases[0].fields);
  // All of them in the full campaign; every 61st (a prime, so
  // that all kinds and cases come up) in the small one.
  const std::size_t stride = shop.small ? 61 : 1;
  for (std::size_t k = 0; k < cases.size() * corrections.size(); k += stride) {
    const auto i = k % cases.size();
    const auto& correction = corrections[k / cases.size()];
    const auto good = cases[i];
    cases[i] = with_mistake(good, correction);
    const auto found = ingest::find_unit_mistakes(cases);
    cases[i] = good;
    const bool alone = std::all_of(found.begin(), found.end(), [&](const auto& m) { return m.i_case == i; });
    tally.count(!found.empty() && alone, good.name + ", " + correction.quantity + ": " +
                                             correction.description +
                                             (found.empty() ? " not found"
                                              : alone       ? ""
                                                            : " accuses another case"));
  }
  return tally;
}

Tally hard_cases(const Workshop& shop) {
  Tally tally;
  for (const auto& data : stability::all_hard_data()) {
    for (const auto& outcome : stability::send_through(data, shop.folder)) {
      tally.count(outcome.passed, data.name + ", " + outcome.stage + ": " + outcome.result);
    }
  }
  return tally;
}

}  // namespace elrom::faults
