#include "elrom/field/possible_inputs.hpp"

#include <array>
#include <cmath>
#include <string_view>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/user_unit.hpp"

namespace elrom::field {
namespace {

constexpr double beyond_everything = 1e12;  // SI, of a unit without a row below

struct Possible {
  std::string_view unit;  ///< SI
  double low, high;
  bool above_low;  ///< the low end itself is impossible
};

constexpr std::array<Possible, 7> known_units{{{"kg/s", 0, 1e6, false},
                                               {"kg", 0, 1e9, false},
                                               {"m", 0, 1e4, true},
                                               {"m3", 0, 1e9, false},
                                               {"kg/m3", 0, 1e5, true},
                                               {"K", 0, 1e4, true},
                                               {"s", 0, 1e9, false}}};
constexpr Possible a_fraction{"1", 0, 1, false};
constexpr Possible anything{"", -beyond_everything, beyond_everything, false};

Possible possible_for(const field::InputInfo& info) {
  if (info.unit == "1" && info.name.ends_with("fraction")) return a_fraction;
  for (const auto& row : known_units)
    if (row.unit == info.unit) return row;
  return anything;
}

}  // namespace

void check_possible(const field::CaseInputs& inputs, const field::InputSchema& schema) {
  for (std::size_t i = 0; i < schema.size(); ++i) {
    const auto possible = possible_for(schema[i]);
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
