#include "elrom/scene/particles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace elrom::scene {
namespace {

// Calls f on each array of the spheres.
template <class P, class F>
void for_each_array(P& p, const F& f) {
  for (auto* vectors : {&p.place, &p.velocity, &p.spin})
    for (auto& component : *vectors) f(component);
  f(p.diameter), f(p.density), f(p.mass), f(p.id), f(p.group), f(p.last_hit), f(p.weight), f(p.contact),
      f(p.born), f(p.touched);
}

}  // namespace

void Particles::add(const Sphere& s) {
  const auto push = [](Vectors& to, const Vec& v) {
    to[0].push_back(v.x), to[1].push_back(v.y), to[2].push_back(v.z);
  };
  push(place, s.place);
  push(velocity, s.velocity);
  if (rotates) push(spin, {});
  if (remembers_hits) last_hit.push_back(-std::numeric_limits<double>::infinity());
  diameter.push_back(s.diameter);
  density.push_back(s.density);
  mass.push_back(s.weight * particle::sphere_mass(s.diameter, s.density));
  if (are_parcels) weight.push_back(s.weight), contact.push_back(s.diameter * std::sqrt(s.weight));
  if (remembers_birth) born.push_back(s.born);
  if (remembers_walls) touched.push_back(0);
  id.push_back(s.id);
  group.push_back(s.group);
}

Sphere Particles::sphere(std::size_t i) const {
  return {get(place, i),
          get(velocity, i),
          diameter[i],
          density[i],
          id[i],
          group[i],
          are_parcels ? weight[i] : 1,
          remembers_birth ? born[i] : 0};
}

void Particles::keep_only(const std::vector<std::uint8_t>& keep) {
  for_each_array(*this, [&](auto& values) {
    if (values.empty()) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < keep.size(); ++i)
      if (keep[i] != 0) values[kept++] = values[i];
    values.resize(kept);
  });
}

std::size_t Particles::bytes() const {
  std::size_t total = 0;
  for_each_array(*this, [&](const auto& values) { total += values.capacity() * sizeof(values[0]); });
  return total;
}

double mass_of(const Particles& p) {
  double sum = 0;
  for (const double mass : p.mass) sum += mass;
  return sum;
}

Vec momentum_of(const Particles& p) {
  Vec sum;
  for (std::size_t i = 0; i < p.size(); ++i) sum += p.mass[i] * get(p.velocity, i);
  return sum;
}

double kinetic_energy_of(const Particles& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec v = get(p.velocity, i);
    sum += 0.5 * p.mass[i] * dot(v, v);
    if (!p.rotates) continue;
    const Vec w = get(p.spin, i);
    sum += 0.05 * p.mass[i] * p.diameter[i] * p.diameter[i] * dot(w, w);  // 1/2 2/5 m r^2
  }
  return sum;
}

double greatest_speed_of(const Particles& p) {
  double most = 0;
  const double *x = p.velocity[0].data(), *y = p.velocity[1].data(), *z = p.velocity[2].data();
  for (std::size_t i = 0; i < p.size(); ++i) most = std::max(most, x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
  return std::sqrt(most);
}

}  // namespace elrom::scene
