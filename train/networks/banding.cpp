#include "elrom/networks/banding.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::networks {
namespace {

std::string band_name(std::size_t band, const std::vector<double>& edges) {
  const auto low = band == 0 ? std::string("0") : base::number(edges[band - 1]);
  return band == edges.size() ? "from " + low : low + " to " + base::number(edges[band]);
}

Band field_band(std::size_t band, const std::vector<double>& column_error, const std::vector<double>& edges) {
  Band result{band_name(band, edges), {}, {}};
  for (std::size_t c = 0; c < column_error.size(); ++c) {
    if (band_of(column_error[c], edges) == band) result.columns.push_back(static_cast<std::int32_t>(c));
  }
  return result;
}

Band plane_band(std::size_t band, const MatrixD& error, const std::vector<double>& edges) {
  Band result{band_name(band, edges), {}, {}};
  const auto here = [&](Eigen::Index p, Eigen::Index c) { return band_of(error(p, c), edges) == band; };
  for (Eigen::Index c = 0; c < error.cols(); ++c) {
    bool any = false;
    for (Eigen::Index p = 0; p < error.rows(); ++p) any = any || here(p, c);
    if (any) result.columns.push_back(static_cast<std::int32_t>(c));
  }
  for (Eigen::Index p = 0; p < error.rows(); ++p) {
    for (const auto c : result.columns) result.mask.push_back(here(p, c) ? 1 : 0);
  }
  return result;
}

}  // namespace

std::size_t band_of(double error, const std::vector<double>& edges) {
  if (!std::isfinite(error)) return edges.size();
  return static_cast<std::size_t>(std::ranges::upper_bound(edges, error) - edges.begin());
}

std::vector<Band> make_bands(const ScreeningResult& screening, const BandSettings& settings) {
  const auto column_error = screening.column_error();
  std::vector<Band> bands;
  for (std::size_t band = 0; band <= settings.edges.size(); ++band) {
    auto next = settings.scope == "plane" ? plane_band(band, screening.error, settings.edges)
                                          : field_band(band, column_error, settings.edges);
    if (!next.columns.empty()) bands.push_back(std::move(next));
  }
  return bands;
}

double equal_bands(const ScreeningResult& a, const ScreeningResult& b, const std::vector<double>& edges) {
  const auto error_a = a.column_error(), error_b = b.column_error();
  check(error_a.size() == error_b.size() && !error_a.empty(), "equal_bands: the same columns");
  std::size_t equal = 0;
  for (std::size_t c = 0; c < error_a.size(); ++c)
    equal += band_of(error_a[c], edges) == band_of(error_b[c], edges);
  return static_cast<double>(equal) / static_cast<double>(error_a.size());
}

}  // namespace elrom::networks
