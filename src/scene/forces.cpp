#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "elrom/base/parallel.hpp"
#include "elrom/scene/effect.hpp"
#include "solids_field.hpp"

namespace elrom::scene {
namespace {

class Gravity final : public Effect {
 public:
  explicit Gravity(const Vec& g) : Effect("gravity", Phase::force, 0, 1e-9), g_(g) {}
  void apply(State& state, double) override {
    const std::array<double, 3> g{g_.x, g_.y, g_.z};
    for (std::size_t a = 0; a < 3; ++a)
      for (auto& push : state.push[a]) push += g[a];
  }

 private:
  Vec g_;
};

class Buoyancy final : public Effect {
 public:
  Buoyancy(const Vec& g, double density)
      : Effect("buoyancy", Phase::force, 0, 2e-9), g_(g), density_(density) {}
  void apply(State& state, double) override {
    for (std::size_t i = 0; i < state.particles.size(); ++i)
      set(state.push, i, get(state.push, i) - (density_ / state.particles.density[i]) * g_);
  }

 private:
  Vec g_;
  double density_;
};

class Drag final : public Effect {
 public:
  Drag(DragLaw law, const particle::Gas& gas, const GasField& field, std::shared_ptr<const CellGrid> grid,
       int n_threads)
      : Effect("drag " + std::string(drag_names.name(law)), Phase::force, 0,
               law == DragLaw::stokes ? 1.5e-8 : 6e-8),
        law_(law),
        gas_(gas),
        field_(field),
        n_threads_(n_threads),
        grid_(std::move(grid)) {
    if (grid_ != nullptr) solids_ = std::make_unique<SolidsField>(*grid_);
  }

  void apply(State& state, double dt) override {
    auto& p = state.particles;
    if (solids_ != nullptr) solids_->spread(p);
    base::parallel_for((p.size() + block_size - 1) / block_size, n_threads_, [&](std::size_t block, int) {
      std::array<Vec, block_size> space;
      const std::size_t first = block * block_size, n = std::min(block_size, p.size() - first);
      const std::span<Vec> gas(space.data(), n);
      field_.velocity(p.place, first, gas);
      for (std::size_t k = 0; k < n; ++k) push(state, first + k, gas[k], dt);
    });
  }
  [[nodiscard]] std::size_t bytes() const override {
    return field_.bytes() + (solids_ != nullptr ? solids_->bytes() + grid_->bytes() : 0);
  }

 private:
  void push(State& state, std::size_t i, const Vec& gas, double dt) const {
    const auto& p = state.particles;
    const Vec v = get(p.velocity, i), others = get(state.push, i);
    const double voidage = solids_ != nullptr ? std::max(least_voidage, 1 - solids_->fraction_at(i)) : 1;
    // Once with the rate at the beginning, once with that of the mean speed found so.
    const Vec first = moved(v, gas, others, rate(p, i, v - gas, voidage), dt);
    const Vec last = moved(v, gas, others, rate(p, i, 0.5 * (v + first) - gas, voidage), dt);
    set(state.push, i, (1 / dt) * (last - v));
  }
  [[nodiscard]] double rate(const Particles& p, std::size_t i, const Vec& slip, double voidage) const {
    const double speed = std::sqrt(dot(slip, slip));
    return particle::drag_rate(law_, p.diameter[i], speed, voidage, gas_) / p.sphere_mass(i);
  }
  static Vec moved(const Vec& v, const Vec& gas, const Vec& others, double rate, double dt) {
    const Vec limit = gas + (1 / rate) * others;
    return limit + std::exp(-rate * dt) * (v - limit);
  }

  DragLaw law_;
  particle::Gas gas_;
  const GasField& field_;
  int n_threads_;
  std::shared_ptr<const CellGrid> grid_;
  std::unique_ptr<SolidsField> solids_;  // only of laws that ask for the voidage
};

}  // namespace

std::unique_ptr<Effect> gravity(const Vec& acceleration) { return std::make_unique<Gravity>(acceleration); }

std::unique_ptr<Effect> buoyancy(const Vec& g, double gas_density) {
  return std::make_unique<Buoyancy>(g, gas_density);
}

std::unique_ptr<Effect> drag(DragLaw law, const particle::Gas& gas, const GasField& field,
                             std::shared_ptr<const CellGrid> grid, int n_threads) {
  return std::make_unique<Drag>(law, gas, field, std::move(grid), n_threads);
}

}  // namespace elrom::scene
