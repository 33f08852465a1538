#include "elrom/surrogate/learn_chebyshev.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/math/linear_algebra.hpp"

namespace elrom::surrogate {
namespace {

using particle::Chebyshev;
using particle::FrameRecords;

constexpr double ridge = 1e-10;  // of the mean diagonal: terms that no record shows stay small

constexpr double narrowest = 1e-4;  // panel: protocol document has head-on pairs alone

struct Panel {
  double low, high;
  std::vector<Eigen::Index> records;
  MatrixD coefficients;  // (rows, terms)
  double error = 0;      // sum of weighed squares
  bool whole = false;    // not to be halved any more
};

class Fit {
 public:
  Fit(const FrameRecords& records, const ChebyshevSettings& settings)
      : records_(records), settings_(settings) {
    shape_ = {.n_inputs = static_cast<std::size_t>(records.inputs.cols()),
              .n_outputs = static_cast<std::size_t>(records.targets.cols()),
              .degree_x = settings.degree_x,
              .degree_y = settings.degree_y};
    low_.push_back(0);
    high_.push_back(1);
    for (Eigen::Index k = 1; k < records.inputs.cols(); ++k) {
      low_.push_back(records.inputs.col(k).minCoeff());
      high_.push_back(records.inputs.col(k).maxCoeff());
    }
    least_ = static_cast<std::size_t>(settings.records_a_term *
                                      static_cast<double>(shape_.n_terms() * (shape_.n_inputs == 2 ? 1 : 5)));
  }

  std::unique_ptr<Chebyshev> run() {
    Panel all{
        low_[0], high_[0], std::vector<Eigen::Index>(static_cast<std::size_t>(records_.inputs.rows())), {}};
    std::iota(all.records.begin(), all.records.end(), 0);
    if (all.records.size() < least_)
      throw InputError(Problem{.what = "too few collisions to learn from",
                               .found = std::to_string(all.records.size()),
                               .expected = std::to_string(least_) + " or more"});
    solve(all);
    panels_.push_back(std::move(all));
    while (panels_.size() < static_cast<std::size_t>(settings_.most_panels)) {
      const auto worst = std::ranges::max_element(
          panels_, {}, [](const Panel& panel) { return panel.whole ? -1.0 : panel.error; });
      if (worst->whole) break;
      halve(static_cast<std::size_t>(worst - panels_.begin()));
    }
    return result();
  }

 private:
  // At the middle record, so that both halves are learned equally well.
  void halve(std::size_t i) {
    auto& panel = panels_[i];
    const auto x = [&](Eigen::Index record) { return records_.inputs(record, 0); };
    const auto middle = panel.records.begin() + static_cast<std::ptrdiff_t>(panel.records.size() / 2);
    std::ranges::nth_element(panel.records, middle, {}, x);
    const double edge = x(*middle);
    Panel left{panel.low, edge, {}, {}}, right{edge, panel.high, {}, {}};
    for (const auto record : panel.records) (x(record) < edge ? left : right).records.push_back(record);
    panel.whole = left.records.size() < least_ || right.records.size() < least_ ||
                  edge - panel.low < narrowest || panel.high - edge < narrowest;
    if (panel.whole) return;
    solve(left);
    solve(right);
    panel = std::move(left);
    panels_.insert(panels_.begin() + static_cast<std::ptrdiff_t>(i) + 1, std::move(right));
  }

  void solve(Panel& panel) const {
    panel.coefficients.resize(static_cast<Eigen::Index>(shape_.n_rows()),
                              static_cast<Eigen::Index>(shape_.n_terms()));
    panel.error = 0;
    Eigen::Index row = 0;
    // Outputs with the same monomials share their equations.
    for (std::size_t output = 0, end; output < shape_.n_outputs; output = end) {
      end = shape_.n_inputs == 2 || output > 0 ? shape_.n_outputs : 3;
      row += solve(panel, output, end, row);
    }
  }

  Eigen::Index solve(Panel& panel, std::size_t first, std::size_t end, Eigen::Index row) const {
    const auto n = static_cast<Eigen::Index>(panel.records.size()), n_terms = panel.coefficients.cols();
    const auto n_outputs = static_cast<Eigen::Index>(end - first);
    std::array<double, 8> space;
    std::vector<double> sample(5);
    const auto n_monomials =
        static_cast<Eigen::Index>(Chebyshev::monomials(shape_, first, sample.data(), space).size());
    MatrixD terms(n, n_monomials * n_terms), targets(n, n_outputs);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto record = panel.records[static_cast<std::size_t>(i)];
      for (Eigen::Index k = 0; k < records_.inputs.cols(); ++k)
        sample[static_cast<std::size_t>(k)] = records_.inputs(record, k);
      const double weight = records_.speed[record];
      double* own = terms.row(i).data();
      Chebyshev::terms(shape_, panel.low, panel.high, low_[1], high_[1], sample.data(), own);
      const auto monomials = Chebyshev::monomials(shape_, first, sample.data() + 2, space);
      for (Eigen::Index l = n_monomials; l-- > 0;)
        terms.row(i).segment(l * n_terms, n_terms) =
            weight * monomials[static_cast<std::size_t>(l)] * terms.row(i).head(n_terms);
      targets.row(i) =
          weight * records_.targets.row(record).matrix().segment(static_cast<Eigen::Index>(first), n_outputs);
    }
    // Columns of one size keep the equations well conditioned.
    const Eigen::VectorXd size =
        terms.colwise().norm().transpose().array().max(std::numeric_limits<double>::min());
    terms *= size.cwiseInverse().asDiagonal();
    Eigen::MatrixXd normal = terms.transpose() * terms;
    normal.diagonal().array() += ridge;
    const Eigen::MatrixXd solution = math::Cholesky(normal).solve(terms.transpose() * targets);
    panel.error += (terms * solution - targets).squaredNorm();
    for (Eigen::Index output = 0; output < n_outputs; ++output)
      for (Eigen::Index l = 0; l < n_monomials; ++l)
        panel.coefficients.row(row + output * n_monomials + l) =
            solution.col(output)
                .segment(l * n_terms, n_terms)
                .cwiseQuotient(size.segment(l * n_terms, n_terms));
    return n_outputs * n_monomials;
  }

  [[nodiscard]] std::unique_ptr<Chebyshev> result() const {
    std::vector<double> edges{panels_.front().low};
    const auto n_rows = static_cast<Eigen::Index>(shape_.n_rows());
    MatrixD coefficients(static_cast<Eigen::Index>(panels_.size()) * n_rows,
                         static_cast<Eigen::Index>(shape_.n_terms()));
    for (std::size_t i = 0; i < panels_.size(); ++i) {
      edges.push_back(panels_[i].high);
      coefficients.middleRows(static_cast<Eigen::Index>(i) * n_rows, n_rows) = panels_[i].coefficients;
    }
    return std::make_unique<Chebyshev>(shape_, edges, low_, high_, coefficients);
  }

  const FrameRecords& records_;
  const ChebyshevSettings& settings_;
  Chebyshev::Shape shape_;
  std::vector<double> low_, high_;
  std::size_t least_ = 0;
  std::vector<Panel> panels_;
};

}  // namespace

std::unique_ptr<Chebyshev> learn_chebyshev(const FrameRecords& records, const ChebyshevSettings& settings) {
  return Fit(records, settings).run();
}

}  // namespace elrom::surrogate
