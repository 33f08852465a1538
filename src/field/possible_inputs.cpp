#include "elrom/field/possible_inputs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/user_unit.hpp"

namespace elrom::field {
namespace {

constexpr double beyond_everything = 1e12;  // SI, of what has no row of its own

struct Possible {
  std::string_view unit;  ///< SI
  std::string_view word;  ///< ends the input's name
  double low, high;
  bool above_low;  ///< the low end itself is impossible
};

constexpr std::array<Possible, 11> known{{{"1", "fraction", 0, 1, false},
                                          {"1", "spread", 0, 1e3, false},
                                          {"1", "ratio", 0, 1e6, false},
                                          {"kg/s", "", 0, 1e6, false},
                                          {"kg", "", 0, 1e9, false},
                                          {"m", "", 0, 1e4, true},
                                          {"m3", "", 0, 1e9, false},
                                          {"kg/m3", "", 0, 1e5, true},
                                          {"K", "", 0, 1e4, true},
                                          {"s", "", 0, 1e9, false},
                                          {"", "", -beyond_everything, beyond_everything, false}}};

const Possible& possible_for(const InputInfo& info) {
  return *std::ranges::find_if(known, [&](const Possible& row) {
    return (row.unit == info.unit || row.unit.empty()) && info.name.ends_with(row.word);
  });
}

}  // namespace

void check_possible(const CaseInputs& inputs, const InputSchema& schema) {
  for (std::size_t i = 0; i < schema.size(); ++i) {
    const auto& possible = possible_for(schema[i]);
    const double value = inputs.values[i];
    const bool low_enough = possible.above_low ? value > possible.low : value >= possible.low;
    if (low_enough && value <= possible.high) continue;
    const auto& unit = user_unit(schema[i]);
    const auto show = [&](double si) { return base::rounded(unit.from_si(si), 6) + " " + unit.symbol; };
    throw InputError({.what = "impossible " + schema[i].name,
                      .where = "case " + inputs.name,
                      .found = show(value),
                      .expected = (possible.above_low ? "above " : "") + show(possible.low) + " to " +
                                  show(possible.high)});
  }
}

}  // namespace elrom::field
