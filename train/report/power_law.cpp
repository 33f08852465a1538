#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/report/learning_curve.hpp"

namespace elrom::report {
namespace {

struct Line {
  double floor = 0, scale = 0, residual = 0;
};

// Least squares of error = floor + scale * basis, with neither below zero.
Line fit_line(const std::vector<double>& basis, const std::vector<double>& errors) {
  const auto n = static_cast<double>(basis.size());
  double sb = 0, se = 0, sbb = 0, sbe = 0;
  for (std::size_t i = 0; i < basis.size(); ++i) {
    sb += basis[i];
    se += errors[i];
    sbb += basis[i] * basis[i];
    sbe += basis[i] * errors[i];
  }
  Line line;
  const double determinant = n * sbb - sb * sb;
  if (determinant > 0) line = {(sbb * se - sb * sbe) / determinant, (n * sbe - sb * se) / determinant};
  if (!(determinant > 0) || line.scale < 0) line = {se / n, 0};
  if (line.floor < 0) line = {0, sbe / sbb};
  for (std::size_t i = 0; i < basis.size(); ++i)
    line.residual += std::pow(line.floor + line.scale * basis[i] - errors[i], 2);
  return line;
}

}  // namespace

double PowerLaw::at(double n_cases) const { return floor + scale * std::pow(n_cases, -rate); }

bool PowerLaw::at_bound() const {
  constexpr double rounding = 1e-6;  // of the steps in which the rate is searched
  return rate < least_rate + rounding || rate > most_rate - rounding || scale == 0 || floor == 0;
}

std::optional<double> PowerLaw::cases_for(double error) const {
  if (at_bound() || error <= floor) return {};
  return std::pow(scale / (error - floor), 1 / rate);
}

PowerLaw fit_power_law(const std::vector<double>& cases, const std::vector<double>& errors) {
  check(cases.size() == errors.size() && !cases.empty(), "fit_power_law: as many errors as numbers of cases");
  PowerLaw best;
  double least = std::numeric_limits<double>::infinity();
  constexpr int n_steps = 78;
  for (int step = 0; step <= n_steps; ++step) {
    const double rate = PowerLaw::least_rate + (PowerLaw::most_rate - PowerLaw::least_rate) * step / n_steps;
    std::vector<double> basis;
    for (const double n : cases) basis.push_back(std::pow(n, -rate));
    const auto line = fit_line(basis, errors);
    if (line.residual >= least * (1 - 1e-9)) continue;
    least = line.residual;
    best = {line.floor, line.scale, rate};
  }
  return best;
}

}  // namespace elrom::report
