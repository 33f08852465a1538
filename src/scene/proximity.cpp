// The source's detection: at the end of a step, spheres that overlap. Each collides once, with a partner
// that has the mean velocity and direction of all that it overlaps; only its own velocity changes, so that
// momentum is lost, and a pair that still overlaps after the next step counts again.

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/scene/neighbours.hpp"
#include "movers.hpp"
#include "walls.hpp"

namespace elrom::scene {
namespace {

class Proximity final : public Mover {
 public:
  Proximity(const Domain& domain, const MoverSettings& settings) : domain_(domain), settings_(settings) {}

  void advance(State& state, double dt) override {
    fly(state, domain_, settings_.walls, dt, settings_.n_threads);
    auto& p = state.particles;
    near_.build(p, domain_, 0, settings_.n_threads);
    hit_.clear();
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!near_.above(i).empty() || !near_.below(i).empty()) hit_.push_back(i);
      for (const auto j : near_.above(i)) state.count_collision(i, static_cast<std::size_t>(j));
    }
    if (!hit_.empty()) collide(p);
  }
  [[nodiscard]] std::size_t bytes() const override {
    return near_.bytes() + hit_.capacity() * sizeof(std::size_t);
  }

 private:
  void collide(Particles& p) {
    particle::Pairs pairs(hit_.size());
    for (std::size_t k = 0; k < hit_.size(); ++k)
      put_mean_partner(p, hit_[k], pairs, static_cast<Eigen::Index>(k));
    settings_.model->impulses(pairs, impulses_);
    for (std::size_t k = 0; k < hit_.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const auto& given = impulses_.linear_1;
      const Vec impulse{given(row, 0), given(row, 1), given(row, 2)};
      set(p.velocity, hit_[k], get(p.velocity, hit_[k]) + (1 / p.mass[hit_[k]]) * impulse);
    }
  }

  void put_mean_partner(const Particles& p, std::size_t i, particle::Pairs& pairs, Eigen::Index row) {
    partners_.assign(near_.below(i).begin(), near_.below(i).end());
    partners_.insert(partners_.end(), near_.above(i).begin(), near_.above(i).end());
    std::ranges::sort(partners_);
    const double share = 1 / static_cast<double>(partners_.size());
    Vec velocity, towards;
    double diameter = 0, density = 0;
    for (const auto j : partners_) {
      const auto at = static_cast<std::size_t>(j);
      velocity += share * get(p.velocity, at);
      towards += domain_.images().nearest(get(p.place, at) - get(p.place, i));
      diameter += share * p.diameter[at];
      density += share * p.density[at];
    }
    const double length = std::sqrt(dot(towards, towards));
    const Vec normal = length > 0 ? (1 / length) * towards : Vec{1, 0, 0};
    const Vec own = get(p.velocity, i);
    pairs.before.velocity_1.row(row) << own.x, own.y, own.z;
    pairs.before.velocity_2.row(row) << velocity.x, velocity.y, velocity.z;
    pairs.normal.row(row) << normal.x, normal.y, normal.z;
    pairs.diameter_1[row] = p.diameter[i], pairs.diameter_2[row] = diameter;
    pairs.density_1[row] = p.density[i], pairs.density_2[row] = density;
  }

  const Domain& domain_;
  MoverSettings settings_;
  NeighbourList near_;
  std::vector<std::size_t> hit_;  // spheres that overlap some other
  std::vector<std::int32_t> partners_;
  particle::Impulses impulses_;
};

}  // namespace

std::unique_ptr<Mover> make_proximity(const Domain& domain, const MoverSettings& settings) {
  check(settings.model != nullptr, "collisions by proximity need a collision model");
  return std::make_unique<Proximity>(domain, settings);
}

}  // namespace elrom::scene
