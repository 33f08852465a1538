#include "elrom/math/kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "elrom/base/enum_names.hpp"

namespace elrom::math {

namespace {
constexpr base::EnumNames<Covariance, 4> covariance_names{"covariance function",
                                                          {{Covariance::exponential, "exponential"},
                                                           {Covariance::matern32, "matern32"},
                                                           {Covariance::matern52, "matern52"},
                                                           {Covariance::gaussian, "gaussian"}}};
}

std::string_view name_of(Covariance covariance) { return covariance_names.name(covariance); }
Covariance covariance_of(std::string_view name) { return covariance_names.value(name); }

double covariance(Covariance kind, double r) {
  switch (kind) {
    case Covariance::exponential:
      return std::exp(-r);
    case Covariance::matern32: {
      const double a = std::sqrt(3.0) * std::min(r, 1e3);
      return (1 + a) * std::exp(-a);
    }
    case Covariance::matern52: {
      const double a = std::sqrt(5.0) * std::min(r, 1e3);
      return (1 + a + a * a / 3) * std::exp(-a);
    }
    case Covariance::gaussian:
      return std::exp(-0.5 * r * r);
  }
  return 0;
}

Eigen::MatrixXd squared_distances(const MatrixD& a, const MatrixD& b) {
  Eigen::MatrixXd distances = -2 * (a * b.transpose());
  distances.colwise() += a.rowwise().squaredNorm();
  distances.rowwise() += b.rowwise().squaredNorm().transpose();
  return distances.cwiseMax(0);
}

Covariances covariances(Covariance kind, const MatrixD& scaled) {
  using Array = Eigen::ArrayXXd;
  Covariances c{squared_distances(scaled, scaled), {}, {}};
  c.squares.diagonal().setZero();
  const Array r = c.squares.array().sqrt().min(1e3);
  const auto decay = [](const Array& exponents) -> Array {
    const Array powers = exponents.exp();         // by itself: within select() it is taken one by one
    return (exponents > -700).select(powers, 0);  // Eigen's own ends above 0
  };
  switch (kind) {
    case Covariance::exponential:
      c.k = decay(-r);
      c.slope = -c.k.array() / r.max(1e-9);
      break;
    case Covariance::matern32: {
      const Array a = std::sqrt(3.0) * r, e = decay(-a);
      c.k = (1 + a) * e;
      c.slope = -3 * e;
      break;
    }
    case Covariance::matern52: {
      const Array a = std::sqrt(5.0) * r, e = decay(-a);
      c.k = (1 + a + a.square() / 3) * e;
      c.slope = -5.0 / 3.0 * (1 + a) * e;
      break;
    }
    case Covariance::gaussian:
      c.k = decay(-0.5 * c.squares.array());
      c.slope = -c.k;
      break;
  }
  return c;
}

}  // namespace elrom::math
