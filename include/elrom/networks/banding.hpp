#pragma once
// Columns go to submodels by the error the screening found for them: [0, e1), [e1, e2), ..., [en, inf). Empty
// bands vanish. Scope `field`: one band a column, in all planes (the source). Scope `plane`: one band a cell;
// a submodel is then a set of columns and a mask over (plane, column).

#include <cstdint>
#include <string>
#include <vector>

#include "elrom/networks/screening.hpp"
#include "elrom/networks/settings.hpp"

namespace elrom::networks {

struct Band {
  std::string name;                   ///< "0.1 to 0.2"
  std::vector<std::int32_t> columns;  ///< ascending
  std::vector<std::uint8_t> mask;     ///< (n_planes, columns.size()); empty: all planes
  bool operator==(const Band&) const = default;
};

/// Every cell belongs to exactly one band; errors that are not finite belong to the last.
[[nodiscard]] std::vector<Band> make_bands(const ScreeningResult& screening, const BandSettings& settings);

/// Number of the band (before empty ones vanish) that an error falls into.
[[nodiscard]] std::size_t band_of(double error, const std::vector<double>& edges);

/// Share of columns that two screenings put into the same band of scope `field`.
[[nodiscard]] double equal_bands(const ScreeningResult& a, const ScreeningResult& b,
                                 const std::vector<double>& edges);

}  // namespace elrom::networks
