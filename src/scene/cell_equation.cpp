#include "cell_equation.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"

namespace elrom::scene {
namespace {

using Matrix = Eigen::SparseMatrix<double>;

class EigenSolver final : public CellSolver {
 public:
  explicit EigenSolver(const CellGrid& grid) : grid_(grid), row_(grid.size(), CellGrid::none) {
    for (std::size_t c = 0; c < grid.size(); ++c)
      if (grid.is_open(c)) row_[c] = static_cast<std::int32_t>(cells_.size()), cells_.push_back(c);
    make_pattern();
  }

  int solve(const CellEquation& equation, std::vector<double>& q, double tolerance) override {
    const auto n = static_cast<Eigen::Index>(cells_.size());
    Eigen::VectorXd right(n), x(n);
    for (Eigen::Index r = 0; r < n; ++r)
      right[r] = equation.right[cells_[static_cast<std::size_t>(r)]],
      x[r] = q[cells_[static_cast<std::size_t>(r)]];
    fill(equation);
    if (right.squaredNorm() == 0) return put(Eigen::VectorXd::Zero(n), q), 0;
    if (is_free(equation)) right.array() -= right.mean(), hold_first(), x.array() -= x[0];
    cg_.setTolerance(tolerance);
    cg_.setMaxIterations(static_cast<Eigen::Index>(20 * std::cbrt(static_cast<double>(n)) + 500));
    cg_.factorize(matrix_);
    x = cg_.solveWithGuess(right, x);
    if (cg_.info() != Eigen::Success || !x.allFinite())
      throw NumericalError(Problem{.what = "the equation of the pressure finds no solution",
                                   .advice = "take a shorter time step"});
    put(x, q);
    return static_cast<int>(cg_.iterations());
  }

 private:
  // Lower triangle by columns: a cell's own entry, then those of its neighbours with a larger row.
  void make_pattern() {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t r = 0; r < cells_.size(); ++r) {
      const auto row = static_cast<int>(r);
      entries.emplace_back(row, row, 1.0);
      for_each_neighbour(cells_[r], [&](int other, std::size_t, std::size_t) {
        if (other > row) entries.emplace_back(other, row, -1.0);
      });
    }
    const auto n = static_cast<Eigen::Index>(cells_.size());
    matrix_.resize(n, n);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    matrix_.makeCompressed();
    for (std::size_t r = 0; r < cells_.size(); ++r)
      for_each_neighbour(cells_[r], [&](int other, std::size_t axis, std::size_t face) {
        const auto row = static_cast<int>(r);
        if (other > row)
          links_.push_back({row, other, &matrix_.coeffRef(other, row) - matrix_.valuePtr(), axis, face});
      });
    cg_.analyzePattern(matrix_);
  }
  template <class Use>
  void for_each_neighbour(std::size_t cell, const Use& use) const {
    for (std::size_t a = 0; a < 3; ++a)
      for (const int side : {-1, 1}) {
        const auto other = grid_.neighbour(cell, a, side);
        if (other == CellGrid::none || static_cast<std::size_t>(other) == cell) continue;
        const auto row = row_[static_cast<std::size_t>(other)];
        if (row != CellGrid::none) use(row, a, grid_.face(cell, a, side));
      }
  }
  void fill(const CellEquation& equation) {
    double* const values = matrix_.valuePtr();
    std::fill_n(values, matrix_.nonZeros(), 0.0);
    for (std::size_t r = 0; r < cells_.size(); ++r)
      values[matrix_.outerIndexPtr()[r]] = equation.diagonal[cells_[r]];
    for (const auto& link : links_) {
      const double conductance = equation.conductance[link.axis][link.face];
      values[link.entry] -= conductance;
      values[matrix_.outerIndexPtr()[link.low]] += conductance;
      values[matrix_.outerIndexPtr()[link.high]] += conductance;
    }
    for (std::size_t r = 0; r < cells_.size(); ++r) {
      double& diagonal = values[matrix_.outerIndexPtr()[r]];
      if (!(diagonal > 0)) diagonal = 1;  // of a cell that nothing touches
    }
  }
  [[nodiscard]] bool is_free(const CellEquation& equation) const {
    return std::ranges::all_of(cells_, [&](std::size_t c) { return equation.diagonal[c] == 0; });
  }
  void hold_first() { matrix_.coeffRef(0, 0) *= 2; }
  void put(const Eigen::VectorXd& x, std::vector<double>& q) const {
    for (std::size_t r = 0; r < cells_.size(); ++r) q[cells_[r]] = x[static_cast<Eigen::Index>(r)];
  }

  // Two rows with a face between them.
  struct Link {
    int low, high;
    std::ptrdiff_t entry;
    std::size_t axis, face;
  };

  const CellGrid& grid_;
  std::vector<Link> links_;
  std::vector<std::int32_t> row_;   // of each cell
  std::vector<std::size_t> cells_;  // of each row
  Matrix matrix_;
  Eigen::ConjugateGradient<Matrix, Eigen::Lower,
                           Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>>>
      cg_;
};

}  // namespace

std::unique_ptr<CellSolver> make_eigen_solver(const CellGrid& grid) {
  return std::make_unique<EigenSolver>(grid);
}

}  // namespace elrom::scene
