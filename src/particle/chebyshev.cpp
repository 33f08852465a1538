#include "elrom/particle/chebyshev.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "elrom/base/error.hpp"
#include "lanes.hpp"

namespace elrom::particle {
namespace {

constexpr int most_degree = 31;
constexpr std::size_t n_even_outputs = 3, n_even = 5, n_odd = 3;
constexpr std::size_t n_bins = 256;  // of the table that finds a panel

// T_0 to T_degree at a place in [-1, 1].
void polynomials(double place, int degree, double* values) {
  values[0] = 1;
  if (degree > 0) values[1] = place;
  for (int k = 2; k <= degree; ++k) values[k] = 2 * place * values[k - 1] - values[k - 2];
}

// [low, high] to [-1, 1]
double place_in(double value, double low, double high) {
  return high > low ? 2 * (std::clamp(value, low, high) - low) / (high - low) - 1 : 0;
}

void expect(bool holds, const char* what) {
  if (!holds) throw InputError(Problem{.what = "broken Chebyshev surrogate", .found = what});
}

std::vector<double> doubles(const io::TensorFile& file, const std::string& name) {
  const auto values = file.tensor(name).f64();
  return {values.begin(), values.end()};
}

}  // namespace

std::size_t Chebyshev::Shape::n_terms() const {
  return static_cast<std::size_t>(degree_x + 1) * static_cast<std::size_t>(degree_y + 1);
}

std::size_t Chebyshev::Shape::n_rows() const {
  return n_inputs == 2 ? n_outputs : n_even_outputs * n_even + (n_outputs - n_even_outputs) * n_odd;
}

Chebyshev::Chebyshev(const Shape& shape, std::vector<double> edges, std::vector<double> low,
                     std::vector<double> high, MatrixD coefficients)
    : shape_(shape),
      edges_(std::move(edges)),
      low_(std::move(low)),
      high_(std::move(high)),
      coefficients_(std::move(coefficients)) {
  expect(shape_.n_inputs == 2 || (shape_.n_inputs == 5 && shape_.n_outputs == 5),
         "inputs other than 2, or 5 for 5 outputs");
  expect(shape_.n_outputs >= 1 && shape_.n_outputs <= 16, "outputs other than 1 to 16");
  expect(shape_.degree_x >= 0 && shape_.degree_x <= most_degree, "a degree in x other than 0 to 31");
  expect(shape_.degree_y >= 0 && shape_.degree_y <= most_degree, "a degree in y other than 0 to 31");
  expect(edges_.size() >= 2, "no panel");
  const auto finite = [](double value) { return std::isfinite(value); };
  expect(std::ranges::all_of(edges_, finite), "an edge that is not finite");
  expect(std::ranges::adjacent_find(edges_, std::greater_equal<>()) == edges_.end(),
         "edges that do not rise");
  expect(low_.size() == shape_.n_inputs && high_.size() == shape_.n_inputs,
         "ranges for another number of inputs");
  expect(std::ranges::all_of(low_, finite) && std::ranges::all_of(high_, finite),
         "a range that is not finite");
  expect(static_cast<std::size_t>(coefficients_.rows()) == n_panels() * shape_.n_rows() &&
             static_cast<std::size_t>(coefficients_.cols()) == shape_.n_terms(),
         "coefficients of another shape");
  expect(coefficients_.allFinite(), "a coefficient that is not finite");
  width_ = (shape_.n_terms() + lane_width - 1) / lane_width * lane_width;
  packed_.assign(static_cast<std::size_t>(coefficients_.rows()) * width_, 0.0);
  for (Eigen::Index row = 0; row < coefficients_.rows(); ++row)
    std::copy_n(coefficients_.row(row).data(), shape_.n_terms(),
                packed_.data() + static_cast<std::size_t>(row) * width_);
  for (std::size_t bin = 0; bin <= n_bins; ++bin) {
    const double x = edges_.front() + (edges_.back() - edges_.front()) * static_cast<double>(bin) / n_bins;
    const auto above = std::upper_bound(edges_.begin() + 1, edges_.end() - 1, x);
    first_panel_.push_back(static_cast<std::uint32_t>(above - edges_.begin() - 1));
  }
}

void Chebyshev::terms(const Shape& shape, double x0, double x1, double low_y, double high_y,
                      const double* sample, double* terms) {
  double in_x[most_degree + 1], in_y[most_degree + 1];
  polynomials(place_in(sample[0], x0, x1), shape.degree_x, in_x);
  polynomials(place_in(sample[1], low_y, high_y), shape.degree_y, in_y);
  for (int i = 0; i <= shape.degree_x; ++i)
    for (int j = 0; j <= shape.degree_y; ++j) *terms++ = in_x[i] * in_y[j];
}

std::span<const double> Chebyshev::monomials(const Shape& shape, std::size_t output, const double* q,
                                             std::array<double, 8>& space) {
  if (shape.n_inputs == 2) {
    space[0] = 1;
    return std::span(space).first(1);
  }
  space = {1, q[0], q[0] * q[0], q[1] * q[1], q[1] * q[2], q[1], q[0] * q[1], q[0] * q[2]};
  return output < n_even_outputs ? std::span(space).first(n_even) : std::span(space).last(n_odd);
}

std::size_t Chebyshev::panel_of(double x) const {
  const double share = (x - edges_.front()) / (edges_.back() - edges_.front());
  auto panel = first_panel_[static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * n_bins)];
  while (panel + 2 < edges_.size() && x >= edges_[panel + 1]) ++panel;
  return panel;
}

namespace {

// Sum over l and terms of m_l C_l,term value_term; `width` is a multiple of the lanes.
template <std::size_t n_monomials>
double product(const double* coefficients, const double* values, std::size_t width, const double* monomials) {
  Lane sum = 0.0;
  for (std::size_t at = 0; at < width; at += lane_width) {
    Lane row = 0.0;
    for (std::size_t l = 0; l < n_monomials; ++l)
      row += monomials[l] * Lane(coefficients + l * width + at, std::experimental::element_aligned);
    sum += row * Lane(values + at, std::experimental::element_aligned);
  }
  return reduce(sum);
}

}  // namespace

template <bool orbit>
void Chebyshev::evaluate_all(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const {
  std::vector<double> values(width_, 0.0);
  std::array<double, 5> sample{};
  std::array<double, 8> space{1};
  for (Eigen::Index s = 0; s < inputs.rows(); ++s) {
    sample[0] = inputs(s, 0);
    sample[1] = inputs(s, 1);
    const auto panel = panel_of(sample[0]);
    terms(shape_, edges_[panel], edges_[panel + 1], low_[1], high_[1], sample.data(), values.data());
    if constexpr (orbit) {
      for (std::size_t k = 2; k < 5; ++k)
        sample[k] = std::clamp(inputs(s, static_cast<Eigen::Index>(k)), low_[k], high_[k]);
      (void)monomials(shape_, 0, sample.data() + 2, space);
    }
    const double* row = packed_.data() + panel * shape_.n_rows() * width_;
    for (std::size_t output = 0; output < shape_.n_outputs; ++output) {
      double& result = outputs(s, static_cast<Eigen::Index>(output));
      if constexpr (!orbit) {
        result = product<1>(row, values.data(), width_, space.data());
        row += width_;
      } else if (output < n_even_outputs) {
        result = product<n_even>(row, values.data(), width_, space.data());
        row += n_even * width_;
      } else {
        result = product<n_odd>(row, values.data(), width_, space.data() + n_even);
        row += n_odd * width_;
      }
    }
  }
}

void Chebyshev::evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const {
  return shape_.n_inputs == 2 ? evaluate_all<false>(inputs, outputs) : evaluate_all<true>(inputs, outputs);
}

void Chebyshev::write(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix + "/kind", kind());
  const std::array<std::int32_t, 4> shape{static_cast<std::int32_t>(shape_.n_inputs),
                                          static_cast<std::int32_t>(shape_.n_outputs), shape_.degree_x,
                                          shape_.degree_y};
  file.set(prefix + "/shape", io::Tensor::copy(shape, {4}));
  file.set(prefix + "/edges", io::Tensor::copy(edges_, {edges_.size()}));
  file.set(prefix + "/low", io::Tensor::copy(low_, {low_.size()}));
  file.set(prefix + "/high", io::Tensor::copy(high_, {high_.size()}));
  file.set(prefix + "/coefficients", io::Tensor::copy(coefficients_));
}

std::unique_ptr<Chebyshev> Chebyshev::read(const io::TensorFile& file, const std::string& prefix) {
  const auto numbers = file.tensor(prefix + "/shape", std::array<std::size_t, 1>{4}).i32();
  for (const auto number : numbers) expect(number >= 0, "a negative size");
  const Shape shape{static_cast<std::size_t>(numbers[0]), static_cast<std::size_t>(numbers[1]), numbers[2],
                    numbers[3]};
  return std::make_unique<Chebyshev>(shape, doubles(file, prefix + "/edges"), doubles(file, prefix + "/low"),
                                     doubles(file, prefix + "/high"),
                                     file.tensor(prefix + "/coefficients").matrix64());
}

}  // namespace elrom::particle
