#pragma once
// How far predicted deviations from the mean are trusted, wavelength by wavelength and cell by cell: the
// factors that make leave-one-out predictions fit best (an empirical Wiener filter). Internal to methods.

#include <array>
#include <optional>

#include "elrom/field/mesh.hpp"
#include "elrom/math/cosine_transform.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::methods {

/// Cells in planes, rows and cells of a row. An axis with a mirror behind its last cell is half of a whole.
struct Box {
  std::array<std::size_t, 3> sizes;
  std::array<bool, 3> mirrored = {};
  std::array<math::Beyond, 3> beyond = {};  ///< what the mirror makes of the values
};

/// Cells of the mesh as a box, when its columns lie in rows of equal y; else nothing.
[[nodiscard]] std::optional<Box> box_of(const field::Mesh& mesh);

class Shrinkage {
 public:
  /// Without a box every factor is 1.
  explicit Shrinkage(const std::optional<Box>& box);

  struct Options {
    bool spectral = true;  ///< factors by wavelength band before those by cell
    double prior = 1e-3;   ///< weight of "trust it", relative to the mean energy of a band or a cell
  };
  /// @param deviations predicted for cases that were left out, (n_cases, n_cells); shrunk on return
  /// @param truth of the same cases
  void learn(MatrixF& deviations, const MatrixF& truth, const Options& options, int n_threads);
  /// Multiplies by what was learned.
  void apply(MatrixF& deviations, int n_threads) const;

 private:
  void learn_bands(MatrixF& deviations, const MatrixF& truth, double prior, int n_threads);
  void learn_cells(const MatrixF& deviations, const MatrixF& truth, double prior);
  void apply_bands(MatrixF& deviations, int n_threads) const;
  void scale_back(MatrixF& spectra, int n_threads) const;  ///< coefficients by their factors, then to cells

  std::optional<Box> box_;
  std::optional<math::CosineTransform> transform_;
  std::vector<std::size_t> band_;  //!< of each coefficient, (n_cells)
  std::size_t n_bands_ = 0;
  Eigen::VectorXf spectral_;  //!< factor of each coefficient, (n_cells); empty: all 1
  Eigen::VectorXf cellwise_;  //!< factor of each cell, (n_cells); empty: all 1
};

/// Sums over a window of cells around each cell, at the border with the border's value repeated, at a mirror
/// with what is seen in it. (n_cells) in and out.
[[nodiscard]] Eigen::VectorXd window_sums(const Eigen::VectorXd& values, const Box& box,
                                          const std::array<std::size_t, 3>& half_widths);

}  // namespace elrom::methods
