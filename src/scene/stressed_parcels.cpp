// Parcels that feel each other as a continuum (model hel). Through a step:
//
//  1 forces push them;
//  2 the pressure of the solids, of kinetic theory and friction, is taken at the end of the step: with the
//    fraction that the pushed velocities would give and p linear in it, an equation over the cells whose
//    solution no step makes unstable. It is solved some times, since p is steep near the packing;
//  3 viscosity evens out velocities between cells, as much as a step can take, and inelastic collisions those
//    within a cell, at the rate at which kinetic theory takes energy from fluctuations;
//  4 they fly; who would enter a cell that is full stays where it was, and collides without restitution with
//    all that the cell holds, as one body. So no cell ever passes its packing, momentum stays, energy falls.
//
// Velocities are taken from parcels to faces and back by the same weights, so the stress keeps momentum.

#include <algorithm>
#include <cmath>

#include "cell_equation.hpp"
#include "elrom/base/error.hpp"
#include "movers.hpp"
#include "solids_field.hpp"
#include "walls.hpp"

namespace elrom::scene {
namespace {

constexpr int rounds = 3;           // of the equation of the pressure
constexpr double tolerance = 1e-6;  // of its solution
constexpr double softest = 1e-3;    // Pa: slope of the pressure where there are no solids
constexpr double most_even = 0.05;  // of a cell's momentum that a face passes on in a step
constexpr double most_fraction = 0.9;
constexpr double patience = 0.05;  // s, in which a cell that is too dense thins out

using Faces = std::array<std::vector<double>, 3>;

class StressedParcels final : public Mover {
 public:
  StressedParcels(const Domain& domain, const MoverSettings& settings)
      : domain_(domain),
        settings_(settings),
        grid_(*settings.grid),
        solids_(grid_),
        equation_(grid_),
        solver_(make_eigen_solver(grid_)),
        pressure_(grid_.size()) {
    for (std::size_t a = 0; a < 3; ++a) flux_[a].resize(grid_.face_count(a));
  }

  void advance(State& state, double dt) override {
    auto& p = state.particles;
    if (p.size() == 0) return;
    if (!state.push[0].empty()) kick(state, dt);
    solids_.spread(p);
    spread_over_faces(p);
    solve_pressure(dt);
    push_by_pressure(p, dt);
    even_out(p, dt);
    before_ = p.place;
    fly(state, domain_, settings_.walls, dt, settings_.n_threads);
    hold_back(state);
  }
  [[nodiscard]] bool takes_push() const override { return true; }
  // A search from nothing, as a run that goes on begins.
  void forget() override { std::ranges::fill(pressure_, 0); }
  [[nodiscard]] std::size_t bytes() const override {
    std::size_t doubles =
        2 * equation_.diagonal.capacity() + pressure_.capacity() + 3 * before_[0].capacity();
    for (std::size_t a = 0; a < 3; ++a) doubles += 2 * flux_[a].capacity();
    return doubles * sizeof(double) + solids_.bytes() + content_.capacity() * sizeof(Content) +
           home_.capacity() * sizeof(std::size_t) + grid_.bytes();
  }
  [[nodiscard]] std::string text() const override {
    return std::to_string(held_) + " parcels were kept out of full cells in the last step";
  }

 private:
  // What a cell holds at the beginning of the flight, as one body.
  struct Content {
    double volume = 0, mass = 0;
    Vec momentum, shift;  // shift: what its spheres' velocities have gained
  };

  static void kick(State& state, double dt) {
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t i = 0; i < state.particles.size(); ++i)
        state.particles.velocity[a][i] += dt * state.push[a][i];
  }

  // Flux of solids through faces, m/s of their volume.
  void spread_over_faces(const Particles& p) {
    const double per_volume = 1 / grid_.volume();
    for (std::size_t a = 0; a < 3; ++a) {
      std::ranges::fill(flux_[a], 0);
      for (std::size_t i = 0; i < p.size(); ++i) {
        const auto shares = grid_.open_faces(get(p.place, i), a);
        for (std::size_t k = 0; k < 8; ++k) {
          const double volume = shares.weight[k] * p.volume(i) * per_volume;
          flux_[a][static_cast<std::size_t>(shares.of[k])] += volume * p.velocity[a][i];
        }
      }
    }
  }

  // Symmetric gradient of the mean velocity, by differences between neighbours that hold solids.
  [[nodiscard]] particle::Strain strain(std::size_t c) const {
    std::array<std::array<double, 3>, 3> g{};
    for (std::size_t b = 0; b < 3; ++b) {
      std::array<std::size_t, 2> ends{c, c};
      double length = 0;
      for (const int side : {-1, 1}) {
        const auto other = grid_.neighbour(c, b, side);
        if (other == CellGrid::none || solids_.mass[static_cast<std::size_t>(other)] == 0) continue;
        ends[side < 0 ? 0 : 1] = static_cast<std::size_t>(other);
        length += grid_.step()[b];
      }
      for (std::size_t a = 0; a < 3 && length > 0; ++a)
        g[a][b] = (solids_.velocity[a][ends[1]] - solids_.velocity[a][ends[0]]) / length;
    }
    particle::Strain strain{g[0][0] + g[1][1] + g[2][2], 0};
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) strain.squared += 0.25 * (g[a][b] + g[b][a]) * (g[a][b] + g[b][a]);
    return strain;
  }

  // The fraction that velocities give where nothing presses.
  [[nodiscard]] double foreseen(std::size_t c, double dt) const {
    double out = 0;
    for (std::size_t a = 0; a < 3; ++a)
      for (const int side : {-1, 1})  // no solids through walls, nor through the floor that gas comes from
        if (!is_wall(c, a, side))
          out += side * flux_[a][grid_.face(c, a, side)] * grid_.volume() / grid_.step()[a];
    // What is too dense already may stay so for a while: made good at once, it would burst.
    const auto& law = settings_.granular;
    const double excess = solids_.fraction[c] - 0.5 * (law.packing + law.friction_from);
    const double kept = std::max(0.0, excess) * std::exp(-dt / patience);
    return solids_.fraction[c] - kept - dt * out / grid_.space(c);
  }

  // Where spheres seldom meet the balance has no bound; but none is faster than what mean velocities differ
  // by from cell to cell.
  [[nodiscard]] double temperature(std::size_t c) const {
    const auto shear = strain(c);
    const double h = std::cbrt(grid_.volume());
    return std::min(particle::algebraic_temperature(settings_.granular, solids_.solids(c), shear),
                    h * h * shear.squared);
  }

  void solve_pressure(double dt) {
    temperature_.assign(grid_.size(), 0), foreseen_.assign(grid_.size(), 0);
    for (std::size_t c = 0; c < grid_.size(); ++c) {
      if (!grid_.is_open(c)) continue;
      foreseen_[c] = foreseen(c, dt);
      if (solids_.mass[c] > 0) temperature_[c] = temperature(c);
    }
    fraction_ = foreseen_;
    for (int round = 0; round < rounds; ++round) {
      set_equation(dt);
      solver_->solve(equation_, pressure_, tolerance);
      for (std::size_t c = 0; c < grid_.size(); ++c)
        if (grid_.is_open(c)) fraction_[c] += (pressure_[c] - guess_[c]) / slope_[c];
    }
  }

  // p(fraction) + slope (new - fraction) = q, and new - foreseen = what q drives through the faces.
  void set_equation(double dt) {
    equation_.clear();
    guess_.assign(grid_.size(), 0), slope_.assign(grid_.size(), softest);
    for (std::size_t c = 0; c < grid_.size(); ++c) {
      if (!grid_.is_open(c)) continue;
      if (solids_.mass[c] > 0) {
        auto solids = solids_.solids(c);
        solids.fraction = std::clamp(fraction_[c], 0.0, most_fraction);
        const auto& law = settings_.granular;
        guess_[c] = particle::granular_pressure(law, solids, temperature_[c]) +
                    particle::frictional_pressure(law, solids.fraction);
        slope_[c] += particle::pressure_slope(law, solids, temperature_[c]);
      }
      equation_.diagonal[c] = grid_.space(c) / slope_[c];
      equation_.right[c] = equation_.diagonal[c] * guess_[c] - grid_.space(c) * (fraction_[c] - foreseen_[c]);
      for (std::size_t a = 0; a < 3; ++a) {
        if (is_wall(c, a, 1)) continue;
        const auto other = static_cast<std::size_t>(grid_.neighbour(c, a, 1));
        const double mass = solids_.mass[c] + solids_.mass[other];
        const double volume =
            solids_.fraction[c] * grid_.space(c) + solids_.fraction[other] * grid_.space(other);
        if (mass > 0)  // the denser side gives, and moves as its own mass lets it
          equation_.conductance[a][grid_.face(c, a, 1)] =
              grid_.volume() / (grid_.step()[a] * grid_.step()[a]) * dt * dt * volume / mass;
      }
    }
  }
  // Mass of solids in a cell over the cells' volume, kg/m3.
  [[nodiscard]] double bulk(std::size_t c) const { return solids_.mass[c] / grid_.volume(); }

  // The force through a face acts on the solids of both its cells, which it changes by the same velocity; so
  // momentum stays, and the few spheres at the surface of a bed move as those they lie on.
  void push_by_pressure(Particles& p, double dt) {
    for (std::size_t a = 0; a < 3; ++a) {
      gained_[a].assign(grid_.size(), 0);
      for (std::size_t c = 0; c < grid_.size(); ++c) {
        if (!(solids_.mass[c] > 0)) continue;
        const double below = change(c, a, -1, dt), above = change(c, a, 1, dt);
        // A wall bears what the solids on it do on their other side; it pushes and does not pull.
        gained_[a][c] = (is_wall(c, a, -1) ? std::max(0.0, above) : below) +
                        (is_wall(c, a, 1) ? std::min(0.0, below) : above);
      }
    }
    give(p);
  }
  [[nodiscard]] bool is_wall(std::size_t c, std::size_t axis, int side) const {
    const auto other = grid_.neighbour(c, axis, side);
    return other == CellGrid::none || !grid_.is_open(static_cast<std::size_t>(other));
  }
  // Of the velocity, by the pressure's gradient at one side.
  [[nodiscard]] double change(std::size_t c, std::size_t axis, int side, double dt) const {
    if (is_wall(c, axis, side)) return 0;
    const auto other = static_cast<std::size_t>(grid_.neighbour(c, axis, side));
    const double h = grid_.step()[axis], most = h / dt;
    const double gradient = side * (std::max(0.0, pressure_[other]) - std::max(0.0, pressure_[c])) / h;
    return std::clamp(-dt * gradient / (bulk(c) + bulk(other)), -most, most);
  }
  // What cells have gained, to the parcels in them.
  void give(Particles& p) const {
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t k = 0; k < 8; ++k)
        for (std::size_t a = 0; a < 3; ++a)
          p.velocity[a][i] +=
              solids_.shares[i].weight[k] * gained_[a][static_cast<std::size_t>(solids_.shares[i].of[k])];
  }

  // Shear viscosity between cells: what one gains the other loses.
  void even_out(Particles& p, double dt) {
    solids_.spread(p);
    const auto& law = settings_.granular;
    viscosity_.assign(grid_.size(), 0);
    for (std::size_t c = 0; c < grid_.size(); ++c)
      if (solids_.mass[c] > 0 && temperature_[c] + solids_.fraction[c] > 0) {
        const auto solids = solids_.solids(c);
        viscosity_[c] = particle::granular_viscosity(law, solids, temperature_[c]) +
                        particle::frictional_viscosity(law, solids.fraction, strain(c));
      }
    for (auto& component : gained_) component.assign(grid_.size(), 0);
    for (std::size_t c = 0; c < grid_.size(); ++c)
      for (std::size_t a = 0; a < 3; ++a) {
        const auto other = grid_.neighbour(c, a, 1);
        if (other != CellGrid::none) exchange(c, static_cast<std::size_t>(other), a, dt);
      }
    if (law.damping) damp(p, dt);
    give(p);
  }
  void damp(Particles& p, double dt) {
    find_damping(p, dt);
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t a = 0; a < 3; ++a) {
        double sum = 0;
        for (std::size_t k = 0; k < 8; ++k) {
          const auto c = static_cast<std::size_t>(solids_.shares[i].of[k]);
          sum += solids_.shares[i].weight[k] * damping_[c] * (solids_.velocity[a][c] - p.velocity[a][i]);
        }
        p.velocity[a][i] += sum;
      }
  }
  // Share of a velocity's distance to the cell's mean that collisions take in a step.
  void find_damping(const Particles& p, double dt) {
    damping_.assign(grid_.size(), 0);
    for (std::size_t i = 0; i < p.size(); ++i)
      for (std::size_t k = 0; k < 8; ++k) {
        const auto c = static_cast<std::size_t>(solids_.shares[i].of[k]);
        double squared = 0;
        for (std::size_t a = 0; a < 3; ++a) squared += std::pow(p.velocity[a][i] - solids_.velocity[a][c], 2);
        damping_[c] += solids_.shares[i].weight[k] * p.mass[i] * squared / 3;
      }
    for (std::size_t c = 0; c < grid_.size(); ++c) {
      if (!(damping_[c] > 0)) continue;
      const auto solids = solids_.solids(c);
      const double temperature = damping_[c] / solids_.mass[c];
      // The energy of the fluctuations is 3/2 eps rho T; velocities fall half as fast.
      const double rate = particle::dissipation(settings_.granular, solids, temperature) /
                          (3 * solids.fraction * solids.density * temperature);
      damping_[c] = 1 - std::exp(-rate * dt);
    }
  }
  void exchange(std::size_t c, std::size_t other, std::size_t axis, double dt) {
    const double sum = viscosity_[c] + viscosity_[other];
    if (!(viscosity_[c] > 0 && viscosity_[other] > 0)) return;
    const double viscosity = 2 * viscosity_[c] * viscosity_[other] / sum, h = grid_.step()[axis];
    const double mass = std::min(dt * viscosity * grid_.volume() / (h * h),
                                 most_even * std::min(solids_.mass[c], solids_.mass[other]));
    for (std::size_t a = 0; a < 3; ++a) {
      const double momentum = mass * (solids_.velocity[a][other] - solids_.velocity[a][c]);
      gained_[a][c] += momentum / solids_.mass[c];
      gained_[a][other] -= momentum / solids_.mass[other];
    }
  }

  void hold_back(State& state) {
    auto& p = state.particles;
    content_.assign(grid_.size(), {});
    home_.resize(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
      home_[i] = grid_.cell_at(get(before_, i));
      auto& content = content_[home_[i]];
      content.volume += p.volume(i);
      content.mass += p.mass[i];
      content.momentum += p.mass[i] * get(p.velocity, i);
    }
    held_ = 0;
    std::size_t next_leaving = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const bool leaves =
          next_leaving < state.leaving.size() && static_cast<std::size_t>(state.leaving[next_leaving]) == i;
      if (leaves) ++next_leaving;
      const auto to = grid_.cell_at(get(p.place, i));
      if (to == home_[i] && !leaves) continue;
      const bool fits =
          leaves || content_[to].volume + p.volume(i) <= settings_.granular.packing * grid_.space(to);
      content_[home_[i]].volume -= fits ? p.volume(i) : 0;
      content_[to].volume += fits && !leaves ? p.volume(i) : 0;
      if (!fits) bump(p, i, to);
    }
    for (std::size_t i = 0; i < p.size(); ++i)
      set(p.velocity, i, get(p.velocity, i) + content_[home_[i]].shift);
  }
  // Two bodies, without restitution: the parcel, and what the cell that it cannot enter held.
  void bump(Particles& p, std::size_t i, std::size_t to) {
    ++held_;
    set(p.place, i, get(before_, i));
    auto& body = content_[to];
    const Vec way = domain_.images().nearest(grid_.centre(to) - grid_.centre(home_[i]));
    const Vec normal = (1 / std::sqrt(dot(way, way))) * way;
    const Vec own = get(p.velocity, i) + content_[home_[i]].shift;
    const Vec theirs = body.mass > 0 ? (1 / body.mass) * body.momentum : Vec{};
    const double closing = dot(own - theirs, normal);
    if (!(closing > 0)) return;
    const double share = body.mass > 0 ? body.mass / (body.mass + p.mass[i]) : 1;
    set(p.velocity, i, get(p.velocity, i) - share * closing * normal);
    content_[home_[i]].momentum -= p.mass[i] * share * closing * normal;
    if (body.mass == 0) return;
    body.shift += (1 - share) * closing * normal;
    body.momentum += body.mass * (1 - share) * closing * normal;
  }

  const Domain& domain_;
  MoverSettings settings_;
  const CellGrid& grid_;
  SolidsField solids_;
  CellEquation equation_;
  std::unique_ptr<CellSolver> solver_;
  std::vector<double> pressure_, temperature_, viscosity_, damping_;  // by cell
  std::vector<double> foreseen_, fraction_, guess_, slope_;           // by cell, of the equation
  Faces flux_;                                                        // by face
  Vectors before_, gained_;
  std::vector<Content> content_;
  std::vector<std::size_t> home_;  // cell of each parcel before it flew
  std::size_t held_ = 0;
};

}  // namespace

std::unique_ptr<Mover> make_stressed_parcels(const Domain& domain, const MoverSettings& settings) {
  check(settings.grid != nullptr, "parcels under stress need a grid");
  return std::make_unique<StressedParcels>(domain, settings);
}

}  // namespace elrom::scene
