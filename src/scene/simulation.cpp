#include "elrom/scene/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/particle/exact_model.hpp"
#include "frozen_gas.hpp"

namespace elrom::scene {
namespace {

constexpr double usual_overlap = 0.01;  // of the smallest sphere, at twice the fastest speed of the beginning

double fastest_of(const SceneSettings& s) {
  double fastest = 1;
  for (const auto& g : s.groups)
    fastest = std::max(fastest, std::sqrt(dot(g.velocity, g.velocity)) + 3 * g.scatter);
  return fastest;
}

// The lightest spheres of the scene: they set time scales of contacts.
particle::Ball smallest_ball(const SceneSettings& s) {
  particle::Ball ball{std::numeric_limits<double>::infinity(), 1};
  for (const auto& g : s.groups) {
    const double smallest = g.smallest.value_or(g.distribution == "value" ? g.diameter : 0.5 * g.diameter);
    if (smallest < ball.diameter) ball = {std::max(smallest, 1e-9), g.density};
  }
  return ball;
}

particle::ContactLaw contact_of(const SceneSettings& s) {
  auto law = s.contact;
  law.kind = particle::law_names.value<UsageError>(s.law);
  const auto ball = smallest_ball(s);
  law.stiffness =
      s.stiffness.value_or(particle::stiffness_for_overlap(usual_overlap, 2 * fastest_of(s), ball, ball));
  law.check();
  return law;
}

std::shared_ptr<const particle::CollisionModel> model_of(const SceneSettings& s,
                                                         const particle::ContactLaw& law) {
  if (s.collision_model == "exact") return std::make_shared<particle::ExactModel>(law);
  return particle::CollisionBundle::read(s.folder / s.collision_model).model;
}

MoverSettings mover_of(const SceneSettings& s, std::shared_ptr<const CellGrid> grid, int n_threads) {
  MoverSettings m;
  m.collisions = collision_names.value<UsageError>(s.collisions);
  m.walls = s.wall_law;
  m.walls.kind = wall_names.value<UsageError>(s.walls);
  m.steps_per_contact = s.steps_per_contact;
  m.n_threads = n_threads;
  if (m.collisions == Collisions::none) return m;
  if (m.collisions == Collisions::hel) {
    m.grid = std::move(grid);
    m.granular = s.granular;
    m.granular.restitution = s.contact.restitution;
    m.granular.radial = particle::radial_names.value<UsageError>(s.radial);
    m.granular.viscosity = particle::flight_viscosity_names.value<UsageError>(s.viscosity);
    return m;
  }
  m.law = contact_of(s);
  if (m.collisions == Collisions::dem) return m;
  m.model = model_of(s, m.law);
  const auto ball = smallest_ball(s);
  m.contact_time = s.contact_time.value_or(particle::PairContact(m.law, ball, ball).duration(1));
  return m;
}

// The mover as an effect of the list.
class Collide final : public Effect {
 public:
  Collide(const std::string& name, Mover& mover, double bytes, double seconds, bool on_cells = false)
      : Effect(name, Phase::motion, bytes, seconds), mover_(mover), on_cells_(on_cells) {}
  [[nodiscard]] bool works_on_cells() const override { return on_cells_; }
  void apply(State& state, double dt) override { mover_.advance(state, dt); }
  [[nodiscard]] std::size_t bytes() const override { return mover_.bytes(); }

 private:
  Mover& mover_;
  bool on_cells_;
};

// What a step costs, roughly: in dem so many steps of the law, each looking at some neighbours.
std::unique_ptr<Effect> motion(const SceneSettings& s, const MoverSettings& m, Mover& mover) {
  const auto name = "collisions " + s.collisions;
  switch (m.collisions) {
    case Collisions::none:
      return std::make_unique<Collide>("motion", mover, 0, 1e-8);
    case Collisions::dem: {
      const auto ball = smallest_ball(s);
      const double step = particle::step_times(m.law, 2 * fastest_of(s), ball, ball).step();
      return std::make_unique<Collide>(name, mover, 250, 6e-8 * std::max(1.0, s.time_step / step));
    }
    case Collisions::hel:
      return std::make_unique<Collide>(name, mover, 220, 2e-6, true);
    case Collisions::helscm:
      return std::make_unique<Collide>(name, mover, 150, 1.5e-7);
    case Collisions::helscm_document:
      break;
  }
  return std::make_unique<Collide>(name, mover, 100, 3e-7);
}

std::int64_t number_of(const GroupSettings& g, const Source& source, base::Seed seed) {
  // Parcels of equal weight: as many as come nearest to what was asked for.
  if (g.number && *g.number > 0)
    return std::max<std::int64_t>(1, std::llround(static_cast<double>(*g.number) / g.parcels));
  if (g.number) return 0;
  double mass = 0;
  std::int64_t n = 0;
  while (mass < *g.mass && n < 20'000'000) {
    base::Random random(seed.derive(source.name).derive(static_cast<std::uint64_t>(n)));
    mass += source.weight * particle::sphere_mass(source.sizes.draw(random), source.density);
    ++n;
  }
  return n;
}

}  // namespace

std::string digest_of(const SceneSettings& settings) {
  auto s = settings;
  s.duration = 0;
  base::Sha256 digest;
  digest.add(std::string_view(to_toml(s)));
  return digest.hex();
}

Simulation::Simulation(SceneSettings settings, int n_threads, const MakeMover& make)
    : settings_(std::move(settings)), n_threads_(n_threads), domain_(settings_.domain()) {
  if (settings_.needs_grid()) grid_ = std::make_shared<CellGrid>(domain_, settings_.cell);
  const auto m = mover_of(settings_, grid_, n_threads_);
  state_.particles.are_parcels = settings_.has_parcels();
  state_.particles.rotates = settings_.rotation;
  state_.particles.remembers_birth = domain_.has_outlets();
  state_.particles.remembers_walls = domain_.has_walls();
  state_.particles.remembers_hits = m.collisions == Collisions::helscm && m.contact_time > 0;
  place_groups();
  add_forces();
  mover_ = make(domain_, m);
  add(motion(settings_, m, *mover_));
  add_openings();
}

Simulation::~Simulation() = default;

void Simulation::add(std::unique_ptr<Effect> effect) { effects_.push_back({std::move(effect)}); }

Body Simulation::region(const std::string& name) const {
  std::vector<std::string> known;
  for (const auto* list : {&settings_.regions, &settings_.boxes})
    for (const auto& box : *list) {
      if (box.name == name) return box.body();
      known.push_back(box.name);
    }
  throw UsageError(
      Problem{.what = "unknown region", .found = "'" + name + "'", .advice = base::name_advice(name, known)});
}

void Simulation::place_groups() {
  const base::Seed seed = base::Seed(settings_.seed).derive("particles");
  for (const auto& g : settings_.groups) {
    if (g.region.empty() && settings_.boxes.empty())
      throw UsageError(
          Problem{.what = "group '" + g.group + "' has no region", .expected = "a box or [[regions]]"});
    if (std::ranges::find(group_names_, g.group) == group_names_.end()) group_names_.push_back(g.group);
    const auto group = std::ranges::find(group_names_, g.group) - group_names_.begin();
    Source source{.name = fmt::format("{} {}", g.group, sources_.size()),
                  .group = static_cast<std::int32_t>(group),
                  .sizes = {.spread = spread_names.value<UsageError>(g.distribution),
                            .mean = g.diameter,
                            .deviation = g.deviation,
                            .smallest = g.smallest.value_or(0),
                            .largest = g.largest.value_or(std::numeric_limits<double>::infinity())},
                  .density = g.density,
                  .region = region(g.region.empty() ? settings_.boxes[0].name : g.region),
                  .arrangement = arrangement_names.value<UsageError>(g.arrangement),
                  .velocity = g.velocity,
                  .scatter = g.scatter,
                  .over = g.over,
                  .weight = g.parcels};
    source.number = number_of(g, source, seed);
    if (g.number && source.number > 0)
      source.weight = static_cast<double>(*g.number) / static_cast<double>(source.number);
    sources_.push_back(source);
  }
  state_.set_groups(group_names_.size());
  placed_.assign(sources_.size(), 0);
  for (std::size_t k = 0; k < sources_.size(); ++k) {
    if (sources_[k].over > 0) continue;
    const auto missing = inject(state_, domain_, sources_[k], seed, sources_[k].number, placed_[k]);
    if (missing > 0)
      throw UsageError(Problem{.what = "no room for the spheres of group '" + settings_.groups[k].group + "'",
                               .found = fmt::format("{} of {} placed", placed_[k], sources_[k].number),
                               .advice = "a larger region, fewer spheres, or arrangement = \"lattice\""});
  }
}

void Simulation::add_forces() {
  const auto& s = settings_;
  if (s.gravity != Vec{}) add(gravity(s.gravity));
  if (s.buoyancy) add(buoyancy(s.gravity, s.gas_properties.density));
  if (s.drag != "none") add_gas(drag_names.value<UsageError>(s.drag));
  has_forces_ = !effects_.empty();
}

void Simulation::add_gas(DragLaw law) {
  const auto& s = settings_;
  if (s.gas == "coupled") {
    flow_ = flow_of(s, domain_, grid_);
    add(coupled_gas(law, *flow_, n_threads_));
    return;
  }
  gas_ = s.gas == "frozen" ? frozen_gas_of(s.folder / s.gas_file, n_threads_) : uniform_gas(s.gas_velocity);
  add(drag(law, s.gas_properties, *gas_, particle::needs_voidage(law) ? grid_ : nullptr, n_threads_));
}

void Simulation::add_openings() {
  const base::Seed seed(settings_.seed);
  if (!settings_.recirculation.empty())
    add(recirculation(domain_, region(settings_.recirculation), settings_.recirculation_velocity,
                      seed.derive("recirculation")));
  else if (domain_.has_outlets())
    add(outlet());
  for (std::size_t k = 0; k < sources_.size(); ++k)
    if (sources_[k].over > 0) add(inlet(domain_, sources_[k], seed.derive("particles"), placed_[k]));
}

std::int64_t Simulation::due() const {
  std::int64_t due = 0;
  for (std::size_t k = 0; k < sources_.size(); ++k) due += sources_[k].number - placed_[k];
  return due;
}

void Simulation::apply(Timed& timed, double dt) {
  const base::Stopwatch watch;
  timed.effect->apply(state_, dt);
  timed.seconds += watch.seconds();
}

// All forces' acceleration over a time.
void Simulation::push(double dt) {
  for (auto& component : state_.push) component.assign(state_.particles.size(), 0);
  for (auto& timed : effects_)
    if (timed.effect->phase() == Phase::force) apply(timed, dt);
}

void Simulation::kick(double dt) {
  push(dt);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t i = 0; i < state_.particles.size(); ++i)
      state_.particles.velocity[a][i] += dt * state_.push[a][i];
}

void Simulation::step() {
  const double dt = settings_.time_step;
  const bool kicks = has_forces_ && !mover_->takes_push();
  if (kicks)
    kick(0.5 * dt);
  else if (has_forces_)
    push(dt);
  for (auto& timed : effects_)
    if (timed.effect->phase() == Phase::motion) apply(timed, dt);
  if (kicks) kick(0.5 * dt);
  const auto before = std::pair(state_.next_id, state_.tally.left);
  for (auto& timed : effects_)
    if (timed.effect->phase() == Phase::exchange) apply(timed, dt);
  if (before != std::pair(state_.next_id, state_.tally.left)) mover_->forget();
  ++state_.step;
  state_.time = static_cast<double>(state_.step) * dt;
  if (!std::isfinite(kinetic_energy_of(state_.particles)))
    throw NumericalError(
        Problem{.what = fmt::format("a sphere's speed is no number after step {}", state_.step),
                .advice = "take a shorter time step"});
}

double Simulation::calls_a_step(const Effect& effect) const {
  return effect.phase() == Phase::force && !mover_->takes_push() ? 2 : 1;
}

void Simulation::try_cells() {
  const auto on_cells = [](const Timed& timed) { return timed.effect->works_on_cells(); };
  if (std::ranges::none_of(effects_, on_cells)) return;
  constexpr int n_steps = 5;
  Simulation trial(settings_, n_threads_);
  for (int k = 0; k < n_steps; ++k) trial.step();  // a gas that starts iterates more than one that flows
  for (auto& timed : trial.effects_) timed.seconds = 0;
  for (int k = 0; k < n_steps; ++k) trial.step();
  const auto n = static_cast<double>(trial.state_.particles.size());
  for (std::size_t k = 0; k < effects_.size(); ++k) {
    const auto& effect = *effects_[k].effect;
    if (!effect.works_on_cells()) continue;
    const double call = trial.effects_[k].seconds / (n_steps * calls_a_step(effect));
    effects_[k].cell_seconds = std::max(0.0, call - n * effect.seconds_a_sphere());
  }
}

std::vector<EffectCost> Simulation::costs() const {
  std::int64_t number = 0;
  for (const auto& source : sources_) number += source.number;
  const auto n = static_cast<double>(number);
  const auto steps = static_cast<double>(settings_.n_steps());
  std::vector<EffectCost> costs{{.name = "particles",
                                 .bytes_estimated = n * ((settings_.rotation ? 108.0 : 84.0) +
                                                         (state_.particles.remembers_birth ? 8.0 : 0.0) +
                                                         (state_.particles.remembers_walls ? 8.0 : 0.0)),
                                 .bytes = static_cast<double>(state_.particles.bytes())}};
  if (has_forces_) {
    double held = 0;
    for (const auto& component : state_.push)
      held += static_cast<double>(component.capacity() * sizeof(double));
    costs.push_back({.name = "forces", .bytes_estimated = 24 * n, .bytes = held});
  }
  for (const auto& timed : effects_) {
    costs.push_back(
        {timed.effect->name(), n * timed.effect->bytes_a_sphere(),
         steps * calls_a_step(*timed.effect) * (n * timed.effect->seconds_a_sphere() + timed.cell_seconds),
         static_cast<double>(timed.effect->bytes()), timed.seconds});
  }
  return costs;
}

}  // namespace elrom::scene
