// Many soft spheres: the discrete element method (Cundall & Strack 1979). A time step of the scene is cut
// into steps that the contact law asks for. Each drifts half, takes the forces there, and drifts the other
// half, so that one evaluation gives second order. Pairs come from lists of neighbours that last many
// steps; forces of contacts are computed on threads and added in the order of the pairs.

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact_force.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/scene/neighbours.hpp"
#include "movers.hpp"
#include "nearest_gap.hpp"
#include "walls.hpp"

namespace elrom::scene {
namespace {

constexpr double soft_pair_seconds = 5e-10;     // of the list, in a step: most of them are not looked at
constexpr double usual_steps_per_contact = 20;  // of StepTimes::step()

// Place and radius of a sphere side by side: what the search for contacts reads, in one piece.
struct Ball {
  double x, y, z, radius;
  [[nodiscard]] Vec place() const { return {x, y, z}; }
};

struct Contact {
  std::int32_t i, j;
  bool is_new;
  Vec force;   // on j; the opposite on i
  Vec moment;  // sphere k turns by its radius times this
};

// A pair that touches, as it is kept while lists change.
struct Kept {
  std::int64_t id_i, id_j;
  double overlap;
  Vec spring;
};

struct WallContact {
  std::int64_t id;
  const Side* side;
  double overlap;
  Vec spring;
};

struct Block {
  std::vector<Contact> contacts;
  double fastest = 0;  // squared
};

template <particle::LawKind kind, bool rough>
class SoftSpheres final : public Mover {
 public:
  SoftSpheres(const Domain& domain, const MoverSettings& settings)
      : domain_(domain), settings_(settings), law_(settings.law) {}

  void advance(State& state, double dt) override {
    auto& p = state.particles;
    if (p.size() == 0) return;
    fastest_ = greatest_speed_of(p);
    n_steps_ = static_cast<std::size_t>(std::max(1.0, std::ceil(dt / longest_step(p) * (1 - 1e-12))));
    const double h = dt / static_cast<double>(n_steps_);
    pack(p);
    if (!fresh_) renew(state, h);
    for (std::size_t k = 0; k < n_steps_; ++k) {
      drift(state, k == 0 ? 0.5 * h : h);
      if (used_ > 0.5 * skin_) renew(state, h);
      find_contacts(state, h);
      kick(state, h);
    }
    drift(state, 0.5 * h);
    unpack(p);
    if (!domain_.has_outlets()) return;
    for (std::size_t i = 0; i < p.size(); ++i)
      if (domain_.has_left(get(p.place, i))) state.leaving.push_back(static_cast<std::int32_t>(i));
  }

  [[nodiscard]] bool takes_push() const override { return true; }
  void forget() override {
    if (fresh_) collect();
    fresh_ = false;
  }
  [[nodiscard]] std::string text() const override {
    return std::to_string(n_steps_) + " steps of the contact law in the last step";
  }
  [[nodiscard]] std::size_t bytes() const override {
    return neighbours_.bytes() + balls_.capacity() * sizeof(Ball) +
           (loaded_.capacity() + quiet_.capacity()) * sizeof(double) +
           (spring_.capacity() + force_.capacity() + moment_.capacity()) * sizeof(Vec) +
           near_wall_.capacity() + ids_.capacity() * sizeof(std::int64_t);
  }
  void save(io::TensorFile& file) const override {
    std::vector<double> pairs, walls;
    for (const auto& k : kept_)
      pairs.insert(pairs.end(), {static_cast<double>(k.id_i), static_cast<double>(k.id_j), k.overlap,
                                 k.spring.x, k.spring.y, k.spring.z});
    for (const auto& k : wall_contacts_)
      walls.insert(walls.end(), {static_cast<double>(k.id), static_cast<double>(domain_.number_of(*k.side)),
                                 k.overlap, k.spring.x, k.spring.y, k.spring.z});
    file.set("contacts", io::Tensor::copy(pairs, {kept_.size(), 6}));
    file.set("wall_contacts", io::Tensor::copy(walls, {wall_contacts_.size(), 6}));
  }
  void load(const io::TensorFile& file) override {
    const auto pairs = rows_of(file, "contacts");
    kept_.clear();
    for (std::size_t k = 0; k + 6 <= pairs.size(); k += 6)
      kept_.push_back({static_cast<std::int64_t>(pairs[k]),
                       static_cast<std::int64_t>(pairs[k + 1]),
                       pairs[k + 2],
                       {pairs[k + 3], pairs[k + 4], pairs[k + 5]}});
    const auto walls = rows_of(file, "wall_contacts");
    wall_contacts_.clear();
    for (std::size_t k = 0; k + 6 <= walls.size(); k += 6)
      wall_contacts_.push_back({static_cast<std::int64_t>(walls[k]),
                                side_of(walls[k + 1]),
                                walls[k + 2],
                                {walls[k + 3], walls[k + 4], walls[k + 5]}});
    fresh_ = false;
  }

 private:
  [[nodiscard]] static std::span<const double> rows_of(const io::TensorFile& file, const char* name) {
    return file.tensor(name, std::array<std::size_t, 2>{io::any_size, 6}).f64();
  }
  [[nodiscard]] const Side* side_of(double number) const {
    const auto at = static_cast<std::size_t>(
        std::clamp(number, 0.0, 6.0 * static_cast<double>(domain_.bodies().size()) - 1));
    return &domain_.bodies()[at / 6].sides[at % 6];
  }
  [[nodiscard]] double longest_step(const Particles& p) const {
    const auto smallest =
        static_cast<std::size_t>(std::min_element(p.mass.begin(), p.mass.end()) - p.mass.begin());
    const particle::Ball ball{p.diameter[smallest], p.density[smallest]};
    const double rule = particle::step_times(settings_.law, std::max(2 * fastest_, 1e-3), ball, ball).step();
    return rule * usual_steps_per_contact / settings_.steps_per_contact;
  }

  void pack(const Particles& p) {
    balls_.resize(p.size());
    for (std::size_t i = 0; i < p.size(); ++i)
      balls_[i] = {p.place[0][i], p.place[1][i], p.place[2][i], 0.5 * p.diameter[i]};
  }
  void unpack(Particles& p) const {
    for (std::size_t i = 0; i < p.size(); ++i) set(p.place, i, balls_[i].place());
  }

  void renew(State& state, double h) {
    auto& p = state.particles;
    if (fresh_) collect();
    unpack(p);
    for (std::size_t i = 0; i < p.size(); ++i) leave_walls(state, i, domain_, get(p.place, i), h);
    if (domain_.images().any())
      for (std::size_t i = 0; i < p.size(); ++i) set(p.place, i, domain_.wrapped(get(p.place, i)));
    pack(p);
    skin_ = best_skin(p, fastest_ * h, soft_pair_seconds);
    neighbours_.build(p, domain_, skin_, settings_.n_threads);
    near_wall_.assign(p.size(), 0);
    for (const auto i : neighbours_.near_wall()) near_wall_[static_cast<std::size_t>(i)] = 1;
    quiet_.assign(p.size(), 0);
    ids_ = p.id;
    restore();
    fresh_ = true;
    used_ = 0;
  }

  // Touching pairs out of the list ...
  void collect() {
    kept_.clear();
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      std::size_t slot = neighbours_.first(i);
      for (const auto j : neighbours_.above(i)) {
        if (loaded_[slot] > 0)
          kept_.push_back(
              {ids_[i], ids_[static_cast<std::size_t>(j)], loaded_[slot], rough ? spring_[slot] : Vec{}});
        ++slot;
      }
    }
  }
  // ... and into the new one. Numbers of spheres rise in their order, so pairs keep theirs.
  void restore() {
    loaded_.assign(neighbours_.size(), 0);
    if (rough) spring_.assign(neighbours_.size(), {});
    const auto index_of = [&](std::int64_t id) {
      const auto found = std::ranges::lower_bound(ids_, id);
      return found != ids_.end() && *found == id ? found - ids_.begin() : -1;
    };
    for (const auto& kept : kept_) {
      const auto i = index_of(kept.id_i), j = index_of(kept.id_j);
      if (i < 0 || j < 0) continue;
      const auto row = neighbours_.above(static_cast<std::size_t>(i));
      const auto at = std::ranges::lower_bound(row, static_cast<std::int32_t>(j));
      if (at == row.end() || *at != j) continue;
      const auto slot =
          neighbours_.first(static_cast<std::size_t>(i)) + static_cast<std::size_t>(at - row.begin());
      loaded_[slot] = kept.overlap;
      if (rough) spring_[slot] = kept.spring;
    }
  }

  void drift(State& state, double h) {
    auto& p = state.particles;
    for_blocks(p.size(), [&](std::size_t, std::size_t first, std::size_t last) {
      const double *u = p.velocity[0].data(), *v = p.velocity[1].data(), *w = p.velocity[2].data();
      for (std::size_t i = first; i < last; ++i) {
        if (reflects() && near_wall_[i] != 0) continue;
        balls_[i].x += h * u[i], balls_[i].y += h * v[i], balls_[i].z += h * w[i];
      }
    });
    if (reflects())
      for (const auto i : neighbours_.near_wall()) drift_by_wall(state, static_cast<std::size_t>(i), h);
    used_ += fastest_ * h;
  }
  void drift_by_wall(State& state, std::size_t i, double h) {
    auto& p = state.particles;
    auto& ball = balls_[i];
    auto flight = flight_of(state, i, h);
    flight.place = ball.place();
    const auto path = follow(domain_, settings_.walls, flight, h);
    ball = {path.place.x, path.place.y, path.place.z, ball.radius};
    set(p.velocity, i, path.velocity);
    if (p.remembers_walls) p.touched[i] = path.touched;
    state.count_wall_hits(static_cast<std::size_t>(p.group[i]), path.hits);
  }
  [[nodiscard]] bool reflects() const { return settings_.walls.kind == Walls::reflect; }

  void find_contacts(State& state, double h) {
    auto& p = state.particles;
    blocks_.resize((p.size() + block_size - 1) / block_size);
    for_blocks(p.size(), [&](std::size_t block, std::size_t first, std::size_t last) {
      blocks_[block].contacts.clear();
      for (std::size_t i = first; i < last; ++i) contacts_of(p, i, h, blocks_[block].contacts);
    });
    force_.resize(p.size());  // kick() leaves them at zero
    if (rough) moment_.resize(p.size());
    for (const auto& block : blocks_)
      for (const auto& contact : block.contacts) {
        const auto i = static_cast<std::size_t>(contact.i), j = static_cast<std::size_t>(contact.j);
        force_[i] -= contact.force, force_[j] += contact.force;
        if (rough) moment_[i] += contact.moment, moment_[j] += contact.moment;
        if (contact.is_new) state.count_collision(i, j);
      }
    if (!reflects()) walls_contacts(state, h);
  }

  void contacts_of(const Particles& p, std::size_t i, double h, std::vector<Contact>& contacts) {
    if (used_ < quiet_[i]) return;
    const Ball me = balls_[i];
    const bool periodic = domain_.images().any();
    std::size_t slot = neighbours_.first(i);
    NearestGap gap;
    for (const auto j : neighbours_.above(i)) {
      const Ball& other = balls_[static_cast<std::size_t>(j)];
      Vec apart{other.x - me.x, other.y - me.y, other.z - me.z};
      if (periodic) apart = domain_.images().nearest(apart);
      const double reach = me.radius + other.radius, squared = dot(apart, apart);
      if (squared < reach * reach)
        contacts.push_back(contact_of(p, i, static_cast<std::size_t>(j), slot, apart, std::sqrt(squared), h));
      else
        loaded_[slot] = 0;
      gap.see(squared, reach);
      ++slot;
    }
    quiet_[i] = used_ + 0.5 * gap.least();
  }

  Contact contact_of(const Particles& p, std::size_t i, std::size_t j, std::size_t slot, const Vec& apart,
                     double distance, double h) {
    const double r_i = balls_[i].radius, r_j = balls_[j].radius;
    const ContactSizes sizes{p.mass[i] * p.mass[j] / (p.mass[i] + p.mass[j]), r_i * r_j / (r_i + r_j)};
    const Vec normal = distance > 0 ? (1 / distance) * apart : Vec{1, 0, 0};
    const Vec velocity = get(p.velocity, j) - get(p.velocity, i);
    ContactMotion motion{r_i + r_j - distance, -dot(velocity, normal), {}};
    Contact contact{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), loaded_[slot] == 0, {}, {}};
    const double push = law_.normal(sizes, motion);
    contact.force = push * normal;
    if constexpr (rough) {
      const double lever = distance / (r_i + r_j);
      const Vec spin = r_i * get(p.spin, i) + r_j * get(p.spin, j);
      motion.slip = velocity + motion.closing * normal - lever * cross(spin, normal);
      if (contact.is_new) spring_[slot] = {};
      rub(sizes, motion, normal, push, lever, h, loaded_[slot], spring_[slot], contact.force, contact.moment);
    }
    loaded_[slot] = motion.overlap;
    return contact;
  }

  // Friction, taken off the force on 2; its moment.
  void rub(const ContactSizes& sizes, const ContactMotion& motion, const Vec& normal, double push,
           double lever, double h, double loaded, Vec& spring, Vec& force, Vec& moment) const {
    spring -= dot(spring, normal) * normal;
    const Vec friction = law_.friction(sizes, motion, push, loaded, h, spring);
    force -= friction;
    moment = lever * cross(normal, friction);
  }

  void walls_contacts(State& state, double h) {
    wall_contacts_.swap(wall_contacts_before_);
    wall_contacts_.clear();
    std::array<const Side*, 6> sides;
    for (const auto number : neighbours_.near_wall()) {
      const auto i = static_cast<std::size_t>(number);
      leave_walls(state, i, domain_, balls_[i].place(), h);
      const std::size_t n = domain_.touching(balls_[i].place(), balls_[i].radius, sides);
      for (std::size_t k = 0; k < n; ++k) wall_contact(state, i, *sides[k], h);
    }
  }

  void wall_contact(State& state, std::size_t i, const Side& side, double h) {
    auto& p = state.particles;
    const double radius = balls_[i].radius, distance = side.distance(balls_[i].place());
    const ContactSizes sizes{p.mass[i], radius};
    const Vec normal = -1.0 * side.normal;  // from the sphere to the wall, which is sphere 2
    const Vec velocity = -1.0 * get(p.velocity, i);
    ContactMotion motion{radius - distance, -dot(velocity, normal), {}};
    auto before = std::ranges::lower_bound(wall_contacts_before_, p.id[i], {}, &WallContact::id);
    const auto is_other = [&] { return before->id == p.id[i] && before->side != &side; };
    while (before != wall_contacts_before_.end() && is_other()) ++before;
    const bool is_new = before == wall_contacts_before_.end() || before->id != p.id[i];
    WallContact contact{p.id[i], &side, motion.overlap, is_new ? Vec{} : before->spring};
    const double push = law_.normal(sizes, motion);
    Vec force = push * normal, moment;
    if constexpr (rough) {
      const double lever = distance / radius;
      motion.slip = velocity + motion.closing * normal - lever * cross(radius * get(p.spin, i), normal);
      rub(sizes, motion, normal, push, lever, h, is_new ? 0 : before->overlap, contact.spring, force, moment);
      moment_[i] += moment;
    }
    force_[i] -= force;
    if (is_new && meets(p, i, domain_.bit(side)))
      state.count_wall_hits(static_cast<std::size_t>(p.group[i]), 1);
    wall_contacts_.push_back(contact);
  }

  // What neither forces nor walls push flies on, but for spheres in contact.
  void kick_touching(Particles& p, double h) {
    double fastest = fastest_ * fastest_;
    for (const auto& block : blocks_)
      for (const auto& contact : block.contacts)
        for (const auto k : {contact.i, contact.j})
          fastest = std::max(fastest, kick_one(p, static_cast<std::size_t>(k), h));
    fastest_ = std::sqrt(fastest);
  }
  // @return its speed, squared
  double kick_one(Particles& p, std::size_t i, double h) {
    const double share = h / p.mass[i];
    const Vec v = get(p.velocity, i) + share * std::exchange(force_[i], {});
    set(p.velocity, i, v);
    if constexpr (rough)
      set(p.spin, i, get(p.spin, i) + (2.5 * share / balls_[i].radius) * std::exchange(moment_[i], {}));
    return dot(v, v);
  }

  void kick(State& state, double h) {
    auto& p = state.particles;
    if (state.push[0].empty() && reflects()) return kick_touching(p, h);
    const bool pushed = !state.push[0].empty();
    for_blocks(p.size(), [&](std::size_t block, std::size_t first, std::size_t last) {
      double fastest = 0;
      for (std::size_t i = first; i < last; ++i) {
        double squared = kick_one(p, i, h);
        if (pushed) {
          const Vec v = get(p.velocity, i) + h * get(state.push, i);
          set(p.velocity, i, v);
          squared = dot(v, v);
        }
        fastest = std::max(fastest, squared);
      }
      blocks_[block].fastest = fastest;
    });
    double fastest = 0;
    for (const auto& block : blocks_) fastest = std::max(fastest, block.fastest);
    fastest_ = std::sqrt(fastest);
  }

  template <class Work>
  void for_blocks(std::size_t n, const Work& work) const {
    base::parallel_for((n + block_size - 1) / block_size, settings_.n_threads, [&](std::size_t block, int) {
      work(block, block * block_size, std::min(n, (block + 1) * block_size));
    });
  }

  const Domain& domain_;
  MoverSettings settings_;
  ContactForce<kind, rough> law_;
  NeighbourList neighbours_;
  bool fresh_ = false;
  double skin_ = 0, used_ = 0, fastest_ = 0;
  std::size_t n_steps_ = 0;
  std::vector<Ball> balls_;
  std::vector<double> quiet_;  // of each sphere: it touches none above it before so much of the list is used
  std::vector<std::int64_t> ids_;  // of the spheres in the list
  std::vector<double> loaded_;     // overlap of each pair of the list; 0: apart
  std::vector<Vec> spring_;        // of each pair, N; empty without friction
  std::vector<Kept> kept_;
  std::vector<Vec> force_, moment_;  // on each sphere; moment over radius
  std::vector<std::uint8_t> near_wall_;
  std::vector<WallContact> wall_contacts_, wall_contacts_before_;  // by id
  std::vector<Block> blocks_;
};

}  // namespace

std::unique_ptr<Mover> make_soft_spheres(const Domain& domain, const MoverSettings& settings) {
  using particle::LawKind;
  settings.law.check();
  const bool rough = settings.law.friction > 0;
  if (settings.law.kind == LawKind::linear) {
    if (rough) return std::make_unique<SoftSpheres<LawKind::linear, true>>(domain, settings);
    return std::make_unique<SoftSpheres<LawKind::linear, false>>(domain, settings);
  }
  if (rough) return std::make_unique<SoftSpheres<LawKind::hertz, true>>(domain, settings);
  return std::make_unique<SoftSpheres<LawKind::hertz, false>>(domain, settings);
}

}  // namespace elrom::scene
