#pragma once
// What spheres are to a grid: volume, mass and momentum, spread over its cells. Internal.

#include "elrom/particle/kinetic_theory.hpp"
#include "elrom/scene/cell_grid.hpp"

namespace elrom::scene {

class SolidsField {
 public:
  explicit SolidsField(const CellGrid& grid) : grid_(grid) {}

  void spread(const Particles& p) {
    for (auto* values : {&fraction, &mass, &surface}) values->assign(grid_.size(), 0);
    for (auto& component : velocity) component.assign(grid_.size(), 0);
    shares.resize(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
      shares[i] = grid_.cells(get(p.place, i));
      for (std::size_t k = 0; k < 8; ++k) {
        const auto c = static_cast<std::size_t>(shares[i].of[k]);
        const double m = shares[i].weight[k] * p.mass[i], v = m / p.density[i];
        mass[c] += m, fraction[c] += v, surface[c] += v / p.diameter[i];
        for (std::size_t a = 0; a < 3; ++a) velocity[a][c] += m * p.velocity[a][i];
      }
    }
    for (std::size_t c = 0; c < grid_.size(); ++c) {
      if (mass[c] == 0) continue;
      fraction[c] /= grid_.space(c);
      for (auto& component : velocity) component[c] /= mass[c];
    }
  }
  /// Where a sphere is.
  [[nodiscard]] double fraction_at(std::size_t i) const {
    double sum = 0;
    for (std::size_t k = 0; k < 8; ++k)
      sum += shares[i].weight[k] * fraction[static_cast<std::size_t>(shares[i].of[k])];
    return sum;
  }
  /// With the mean diameter that has their volume and surface. @param c holds some
  [[nodiscard]] particle::Solids solids(std::size_t c) const {
    const double volume = fraction[c] * grid_.space(c);
    return {fraction[c], mass[c] / volume, volume / surface[c]};
  }
  [[nodiscard]] std::size_t bytes() const {
    return (fraction.capacity() + mass.capacity() + surface.capacity() + 3 * velocity[0].capacity()) *
               sizeof(double) +
           shares.capacity() * sizeof(Shares);
  }

  std::vector<double> fraction, mass;  ///< by cell, of its space inside the domain; kg
  Vectors velocity;                    ///< mean by mass, m/s
  std::vector<double> surface;         ///< volume over diameter, m2
  std::vector<Shares> shares;          ///< of each sphere, by cells

 private:
  const CellGrid& grid_;
};

}  // namespace elrom::scene
