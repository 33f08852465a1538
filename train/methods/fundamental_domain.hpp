#pragma once
// Where a class of a mirror-symmetric field need be known: one column of each orbit, the others follow by the
// class's signs. With two mirrors this is a quarter of the cells, and so of the work. Internal to methods.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "elrom/model/symmetry_fold.hpp"
#include "shrinkage.hpp"
#include "symmetry_classes.hpp"

namespace elrom::methods {

/// One column of each orbit, all orbits being equally large. Its values are kept times the root of that
/// size, so that sums of products over its cells are those over all cells. All cells where there is no such
/// domain: without mirrors, with one that exchanges planes or has columns on it, or where its columns are no
/// corner of the mesh's box. Thread rule: const use from any thread.
class FundamentalDomain {
 public:
  FundamentalDomain(const field::CaseSet& cases, field::Parity parity,
                    const std::vector<SymmetryClass>& classes);

  [[nodiscard]] std::size_t n_planes() const { return n_planes_; }
  [[nodiscard]] std::size_t n_columns() const { return columns_.size(); }  ///< of the domain
  [[nodiscard]] std::size_t n_cells() const { return n_planes_ * columns_.size(); }
  [[nodiscard]] std::size_t n_all_cells() const { return n_planes_ * n_all_columns_; }
  /// Whether every mirror keeps cells on their plane, and does so alike on all planes.
  [[nodiscard]] bool keeps_planes() const { return keeps_planes_; }
  /// The domain as a box, and what a class does behind its ends; nothing where the mesh is none.
  [[nodiscard]] std::optional<Box> box(std::size_t i_class) const;
  /// For modes of the whole field; may be empty.
  [[nodiscard]] const model::SymmetryFold& fold() const { return fold_; }

  /// Projections of the given rows on a class, product over mirrors of (1 + sign * M) / 2, (rows.size(),
  /// n_cells()), times the root. The classes' projections, added to the same cells, give the rows.
  [[nodiscard]] MatrixF project(const MatrixF& values, std::span<const std::size_t> rows, std::size_t i_class,
                                int n_threads) const;
  /// cells += part over the root, with its signs in the columns outside the domain.
  /// @param part (n, n_cells()) @param cells (n, all cells)
  void add(std::size_t i_class, const MatrixF& part, Eigen::Ref<MatrixF> cells, int n_threads) const;

 private:
  void take_domain(const field::CaseSet& cases);

  std::size_t n_planes_, n_all_columns_;
  bool keeps_planes_ = true;
  bool is_whole_ = true;               // all cells
  float root_ = 1;                     // of the orbits' size
  std::vector<std::int32_t> columns_;  // of the domain, ascending
  std::optional<Box> box_;             // without what is beyond
  model::SymmetryFold fold_;
  std::vector<std::vector<std::int32_t>> images_;  // of the domain's cells under every product of mirrors
  std::vector<std::vector<float>> signs_;          // of those images in each class
  std::vector<std::size_t> axes_;                  // of the box, of each mirror
  std::vector<std::vector<math::Beyond>> beyond_;  // of each class behind each mirror
};

}  // namespace elrom::methods
