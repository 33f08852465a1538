#pragma once
// What the page draws of the fields: vertical cuts through the
// furnace, axial profiles and histograms of errors.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/mesh.hpp"

namespace elrom::report {

/// A cut, as a rule vertical: cells in its plane as quadrilaterals of (horizontal, vertical) corners.
struct Cut {
  std::string title;       ///< "y = 13.80 m"
  std::string horizontal;  ///< "x [m]"
  std::string vertical = "z [m]";
  //! A cut between two rows of cells shows their mean; else both equal
  std::vector<std::array<std::size_t, 2>> cells;
  //! [m], counter-clockwise from lower left, same length as cells
  std::vector<std::array<float, 8>> corners;
};

/// Middle cuts along x and along y; a mesh of one row has one cut. Where columns come in no rows, or there is
/// one plane: boxes around the cells that the middle planes go through; a flat mesh has one cut, all of it.
[[nodiscard]] std::vector<Cut> middle_cuts(const field::Mesh& mesh);
/// Values of a field on all cuts, one after the other.
[[nodiscard]] std::vector<float> on_cuts(const std::vector<Cut>& cuts, std::span<const float> cells);

/// Volume-weighted mean of each plane, (n_planes).
[[nodiscard]] std::vector<double> plane_means(const field::Mesh& mesh, std::span<const float> cells);

/// Counts in equal bins; what falls outside is counted in the end bins.
struct Histogram {
  double low = 0, high = 1;
  std::vector<std::uint64_t> counts;
  Histogram() = default;
  Histogram(double low_edge, double high_edge, std::size_t n_bins);
  void add(double value);
  [[nodiscard]] std::uint64_t total() const;
};

/// Truth against prediction on a square grid of bins.
struct ParityMap {
  double low = 0, high = 1;
  std::size_t n_bins = 0;
  std::vector<std::uint64_t> counts;  //!< (n_bins truth, n_bins prediction)
  ParityMap() = default;
  ParityMap(double low_edge, double high_edge, std::size_t bins);
  void add(double truth, double prediction);
};

/// One field's drawings.
struct FieldFigures {
  //! [case][series]: truth, then methods; empty: not kept
  std::vector<std::vector<std::vector<float>>> cuts;
  std::vector<std::vector<std::vector<double>>> profiles;  //!< [case][series][plane]
  std::vector<std::vector<double>> half_width;  //!< [case][plane]: mean 90 % half-width; empty: none
  std::vector<Histogram> errors;                //!< by method, over all scored cases
  ParityMap parity;                             ///< of the study's model
};

struct Figures {
  std::vector<Cut> cuts;
  std::vector<double> heights;  //!< [m], (n_planes)
  std::vector<FieldFigures> fields;
  std::vector<std::size_t> cut_methods;  ///< methods whose cuts are kept: series 1 ... of FieldFigures::cuts
};

}  // namespace elrom::report
