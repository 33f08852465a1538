// Gas and spheres push each other. The force of drag on a sphere is taken with the velocity that it gives:
// K/(1 + K dt/m) (u - v - dt a), which no K makes unstable, and the gas gets the opposite, face by face with
// the weights that its velocity was read with. So momentum stays, to rounding.

#include <cmath>

#include "elrom/base/parallel.hpp"
#include "elrom/scene/effect.hpp"
#include "solids_field.hpp"

namespace elrom::scene {
namespace {

class CoupledGas final : public Effect {
 public:
  CoupledGas(DragLaw law, GasFlow& flow, int n_threads)
      : Effect("coupled gas, drag " + std::string(drag_names.name(law)), Phase::force, 400, 1.5e-6),
        law_(law),
        flow_(flow),
        n_threads_(n_threads),
        load_(flow.no_load()),
        solids_(flow.grid()) {}

  void apply(State& state, double dt) override {
    const auto& p = state.particles;
    solids_.spread(p);
    sides_.resize(p.size());
    answer(state, flow_.pressure_gradient(), dt);
    load(p);
    flow_.advance(dt, load_);
    push(state);
  }
  [[nodiscard]] bool works_on_cells() const override { return true; }
  [[nodiscard]] std::size_t bytes() const override {
    std::size_t doubles = 0;
    for (std::size_t a = 0; a < 3; ++a) doubles += 4 * load_.solids[a].capacity();
    return doubles * sizeof(double) + solids_.bytes() + flow_.bytes() + sides_.capacity() * sizeof(Sphere);
  }
  void save(io::TensorFile& file) const override { flow_.save(file); }
  void load(const io::TensorFile& file) override { flow_.load(file); }

 private:
  struct Sphere {
    std::array<Shares, 3> faces;
    double answer;  // K/(1 + K dt/m) of one sphere, kg/s
    Vec expected;   // velocity without drag at the end of the step
  };

  void answer(const State& state, const FaceValues& gradient, double dt) {
    const auto& p = state.particles;
    base::parallel_for((p.size() + block_size - 1) / block_size, n_threads_, [&](std::size_t block, int) {
      for (std::size_t i = block * block_size; i < std::min(p.size(), (block + 1) * block_size); ++i) {
        auto& s = sides_[i];
        const Vec place = get(p.place, i), v = get(p.velocity, i);
        for (std::size_t a = 0; a < 3; ++a) s.faces[a] = flow_.grid().faces(place, a);
        const Vec slip = read(flow_.velocity(), s.faces) - v;
        const double voidage = std::max(least_voidage, 1 - solids_.fraction_at(i));
        const double k =
            particle::drag_rate(law_, p.diameter[i], std::sqrt(dot(slip, slip)), voidage, flow_.gas());
        s.answer = k / (1 + dt * k / p.sphere_mass(i));
        s.expected = v + dt * (get(state.push, i) - (1 / p.density[i]) * read(gradient, s.faces));
      }
    });
  }

  void load(const Particles& p) {
    for (auto* values : {&load_.solids, &load_.solids_flux, &load_.exchange, &load_.exchange_flux})
      for (auto& component : *values) std::ranges::fill(component, 0);
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto& s = sides_[i];
      const double spheres = p.are_parcels ? p.weight[i] : 1;
      const std::array<double, 3> expected{s.expected.x, s.expected.y, s.expected.z};
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t k = 0; k < 8; ++k) {
          const auto f = static_cast<std::size_t>(s.faces[a].of[k]);
          const double share = s.faces[a].weight[k] / flow_.grid().face_volume(a, f);
          const double volume = share * p.volume(i), exchange = share * spheres * s.answer;
          load_.solids[a][f] += volume;
          load_.solids_flux[a][f] += volume * p.velocity[a][i];
          load_.exchange[a][f] += exchange;
          load_.exchange_flux[a][f] += exchange * expected[a];
        }
    }
  }

  void push(State& state) {
    const auto& p = state.particles;
    const auto gradient = flow_.pressure_gradient();
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto& s = sides_[i];
      const Vec drag = (s.answer / p.sphere_mass(i)) * (read(flow_.mean_velocity(), s.faces) - s.expected);
      set(state.push, i, get(state.push, i) + drag - (1 / p.density[i]) * read(gradient, s.faces));
    }
  }

  DragLaw law_;
  GasFlow& flow_;
  int n_threads_;
  GasLoad load_;
  SolidsField solids_;
  std::vector<Sphere> sides_;
};

}  // namespace

std::unique_ptr<Effect> coupled_gas(DragLaw law, GasFlow& flow, int n_threads) {
  return std::make_unique<CoupledGas>(law, flow, n_threads);
}

}  // namespace elrom::scene
