#pragma once
// Chebyshev polynomials on panels: smooth inside a panel, with kinks (where friction changes from sliding to
// sticking) between them.
//
//   f(x, y, q) = sum over i, j, l of C_ijl T_i(x in its panel) T_j(y) m_l(q)
//
// Of two inputs there is one m = 1. Of five (frame_model.hpp) q is the orbit, which turns normal and slip in
// first and second order; a collision and its mirror image in the plane of normal and slip must agree, so the
// first three outputs have m = 1, q1, q1^2, q2^2, q2 q3, and the other two m = q2, q1 q2, q1 q3. Values
// outside the fitted range of an input count as its nearest end.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "elrom/particle/regressor.hpp"

namespace elrom::particle {

class Chebyshev final : public Regressor {
 public:
  struct Shape {
    std::size_t n_inputs = 2, n_outputs = 3;  ///< 2 inputs and any outputs, or 5 and 5
    int degree_x = 3, degree_y = 3;
    bool operator==(const Shape&) const = default;
    [[nodiscard]] std::size_t n_terms() const;  ///< of T_i(x) T_j(y)
    [[nodiscard]] std::size_t n_rows() const;   ///< of coefficients, a panel: all outputs' monomials
  };
  /// @param edges of the panels in x, rising, (panels + 1)
  /// @param low, high of each input
  /// @param coefficients (panels x rows, terms): rows of an output's
  /// monomials one after the other; terms with j fastest
  /// @throws InputError for sizes that do not fit, edges that do not rise, values that are not finite
  Chebyshev(const Shape& shape, std::vector<double> edges, std::vector<double> low, std::vector<double> high,
            MatrixD coefficients);

  [[nodiscard]] std::string kind() const override { return "chebyshev"; }
  [[nodiscard]] std::size_t n_inputs() const override { return shape_.n_inputs; }
  [[nodiscard]] std::size_t n_outputs() const override { return shape_.n_outputs; }
  [[nodiscard]] std::size_t n_panels() const { return edges_.size() - 1; }
  void evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const override;
  void write(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<Chebyshev> read(const io::TensorFile& file, const std::string& prefix);

  /// T_i(x) T_j(y) of a sample in the panel [x0, x1], (n_terms).
  static void terms(const Shape& shape, double x0, double x1, double low_y, double high_y,
                    const double* sample, double* terms);
  /// m_l(q) of an output, as many as it has.
  [[nodiscard]] static std::span<const double> monomials(const Shape& shape, std::size_t output,
                                                         const double* q, std::array<double, 8>& space);

 private:
  [[nodiscard]] std::size_t panel_of(double x) const;
  template <bool orbit>
  void evaluate_all(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const;

  Shape shape_;
  std::vector<double> edges_, low_, high_;
  MatrixD coefficients_;
  std::size_t width_ = 0;                   // n_terms, filled up to whole lanes
  std::vector<double> packed_;              // coefficients in rows of that width
  std::vector<std::uint32_t> first_panel_;  // that may hold x, for even steps of x
};

}  // namespace elrom::particle
