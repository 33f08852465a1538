#include "elrom/scene/inlet.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "elrom/base/error.hpp"

namespace elrom::scene {
namespace {

constexpr int most_tries = 300;  // of a random place

struct Box {
  Vec low, high;
};

Box box_around(const Body& body) {
  Box box{body.corners[0], body.corners[0]};
  for (const auto& c : body.corners) {
    box.low = {std::min(box.low.x, c.x), std::min(box.low.y, c.y), std::min(box.low.z, c.z)};
    box.high = {std::max(box.high.x, c.x), std::max(box.high.y, c.y), std::max(box.high.z, c.z)};
  }
  return box;
}

bool holds(const Body& region, const Vec& place, double radius) {
  return std::ranges::all_of(region.sides,
                             [&](const Side& side) { return side.distance(place) >= radius * (1 - 1e-9); });
}

// A place in the region where a sphere fits; nothing after many tries.
std::optional<Vec> random_place(const Placer& placer, const Body& region, double radius,
                                base::Random& random) {
  const auto [low, high] = box_around(region);
  for (int k = 0; k < most_tries; ++k) {
    const double x = random.uniform(low.x, high.x), y = random.uniform(low.y, high.y),
                 z = random.uniform(low.z, high.z);
    const Vec place{x, y, z};
    if (holds(region, place, radius) && placer.fits(place, radius)) return place;
  }
  return std::nullopt;
}

// Cubes from the lowest corner up.
std::optional<Vec> lattice_place(const Placer& placer, const Body& region, double spacing, double radius,
                                 std::int64_t& site) {
  const auto [low, high] = box_around(region);
  const auto along = [&](double from, double to) {
    return std::max<std::int64_t>(1, static_cast<std::int64_t>((to - from) / spacing));
  };
  const auto nx = along(low.x, high.x), ny = along(low.y, high.y), nz = along(low.z, high.z);
  while (site < nx * ny * nz) {
    const auto k = site++;
    const Vec step{static_cast<double>(k % nx), static_cast<double>(k / nx % ny),
                   static_cast<double>(k / nx / ny)};
    const Vec place = low + spacing * (step + Vec{0.5, 0.5, 0.5});
    if (holds(region, place, radius) && placer.fits(place, radius)) return place;
  }
  return std::nullopt;
}

// Of a sphere with the volume of a parcel.
double room_of(double diameter, double weight) {
  return weight == 1 ? diameter : diameter * std::cbrt(weight);
}
double room_of(const Particles& p, std::size_t i) {
  return p.are_parcels ? room_of(p.diameter[i], p.weight[i]) : p.diameter[i];
}

double largest_of(const Particles& p) {
  double largest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) largest = std::max(largest, room_of(p, i));
  return largest;
}

class Inlet final : public Effect {
 public:
  Inlet(const Domain& domain, const Source& source, base::Seed seed, std::int64_t& placed)
      : Effect("inlet " + source.name, Phase::exchange, 0, 1e-9),
        domain_(domain),
        source_(source),
        seed_(seed),
        placed_(placed) {}
  void apply(State& state, double dt) override {
    const double share = std::min(1.0, (state.time + dt) / source_.over);
    const auto due =
        static_cast<std::int64_t>(std::floor(share * static_cast<double>(source_.number) + 1e-9));
    if (due > placed_) inject(state, domain_, source_, seed_, due, placed_, state.time + dt);
  }

 private:
  const Domain& domain_;
  Source source_;
  base::Seed seed_;
  std::int64_t& placed_;
};

// @param now end of the step
void take_leaving(State& state, double now, std::vector<Sphere>* into) {
  if (state.leaving.empty()) return;
  auto& p = state.particles;
  std::vector<std::uint8_t> keep(p.size(), 1);
  for (const auto i : state.leaving) {
    const auto at = static_cast<std::size_t>(i);
    if (into != nullptr) into->push_back(p.sphere(at));
    keep[at] = 0;
    state.tally.residence[static_cast<std::size_t>(p.group[at])].add(now - p.born[at]);
  }
  p.keep_only(keep);
  state.tally.left += static_cast<std::int64_t>(state.leaving.size());
  state.leaving.clear();
}

class Outlet final : public Effect {
 public:
  Outlet() : Effect("outlet", Phase::exchange, 1, 1e-9) {}
  void apply(State& state, double dt) override { take_leaving(state, state.time + dt, nullptr); }
};

class Recirculation final : public Effect {
 public:
  Recirculation(const Domain& domain, const Body& region, const Vec& velocity, base::Seed seed)
      : Effect("recirculation", Phase::exchange, 1, 2e-9),
        domain_(domain),
        region_(region),
        velocity_(velocity),
        seed_(seed) {}
  // What left in this step waits for the next one.
  void apply(State& state, double dt) override {
    const auto before = std::move(state.waiting);
    state.waiting.clear();
    if (!before.empty()) bring_back(state, before, state.time + dt);
    take_leaving(state, state.time + dt, &state.waiting);
  }

 private:
  void bring_back(State& state, const std::vector<Sphere>& spheres, double now) {
    double largest = largest_of(state.particles);
    for (const auto& s : spheres) largest = std::max(largest, room_of(s.diameter, s.weight));
    Placer placer(state.particles, domain_, largest);
    for (auto sphere : spheres) {
      base::Random random(seed_.derive(static_cast<std::uint64_t>(state.tally.returned)));
      const double radius = 0.5 * room_of(sphere.diameter, sphere.weight);
      const auto place = random_place(placer, region_, radius, random);
      if (!place) {
        state.waiting.push_back(sphere);
        continue;
      }
      placer.add(*place, radius);
      sphere.place = *place;
      sphere.velocity = velocity_;
      sphere.born = now;
      sphere.id = state.next_id++;
      state.particles.add(sphere);
      ++state.tally.returned;
    }
  }

  const Domain& domain_;
  Body region_;
  Vec velocity_;
  base::Seed seed_;
};

}  // namespace

double Sizes::draw(base::Random& random) const {
  if (spread == SizeSpread::value) return mean;
  const double width = std::sqrt(std::log1p(deviation * deviation / (mean * mean)));
  for (int k = 0; k < 10000; ++k) {
    const double normal = random.normal();
    const double drawn = spread == SizeSpread::normal ? mean + deviation * normal
                                                      : mean * std::exp(width * normal - 0.5 * width * width);
    if (drawn >= smallest && drawn <= largest && drawn > 0) return drawn;
  }
  throw UsageError(Problem{.what = "hardly any diameter of this distribution lies within its range"});
}

struct Placer::Grid {
  struct Ball {
    Vec place;
    double radius;
  };
  double size;
  bool bounded = false;
  Vec low, high;  // of a periodic domain
  std::unordered_map<std::int64_t, std::vector<Ball>> cells;

  [[nodiscard]] bool is_near(const Vec& p) const {
    const auto within = [&](double x, double from, double to) { return x > from - size && x < to + size; };
    return !bounded ||
           (within(p.x, low.x, high.x) && within(p.y, low.y, high.y) && within(p.z, low.z, high.z));
  }
  [[nodiscard]] std::array<std::int64_t, 3> cell(const Vec& p) const {
    const auto along = [&](double x) {
      return static_cast<std::int64_t>(std::clamp(std::floor(x / size), -1e6, 1e6));
    };
    return {along(p.x), along(p.y), along(p.z)};
  }
  static std::int64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return x + (std::int64_t{1} << 21) * (y + (std::int64_t{1} << 21) * z);
  }
};

Placer::Placer(const Particles& p, const Domain& domain, double largest)
    : domain_(domain), grid_(std::make_unique<Grid>()) {
  grid_->size = largest;
  grid_->bounded = domain.images().any();
  if (grid_->bounded) grid_->low = domain.low(), grid_->high = domain.high();
  for (std::size_t i = 0; i < p.size(); ++i) add(get(p.place, i), 0.5 * room_of(p, i));
}
Placer::~Placer() = default;

void Placer::add(const Vec& place, double radius) {
  // Images beside a periodic domain are there as spheres of their own.
  const Vec period = domain_.images().period, inside = domain_.wrapped(place);
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, 0.0, 1.0})
      for (const double z : {-1.0, 0.0, 1.0}) {
        if ((x != 0 && period.x == 0) || (y != 0 && period.y == 0) || (z != 0 && period.z == 0)) continue;
        const Vec image = inside + Vec{x * period.x, y * period.y, z * period.z};
        if (!grid_->is_near(image)) continue;
        const auto [cx, cy, cz] = grid_->cell(image);
        grid_->cells[Grid::key(cx, cy, cz)].push_back({image, radius});
      }
}

bool Placer::fits(const Vec& place, double radius) const {
  if (domain_.distance(place) < radius * (1 - 1e-9)) return false;
  const auto [cx, cy, cz] = grid_->cell(place);
  for (std::int64_t z = cz - 1; z <= cz + 1; ++z)
    for (std::int64_t y = cy - 1; y <= cy + 1; ++y)
      for (std::int64_t x = cx - 1; x <= cx + 1; ++x) {
        const auto found = grid_->cells.find(Grid::key(x, y, z));
        if (found == grid_->cells.end()) continue;
        for (const auto& ball : found->second) {
          const Vec d = ball.place - place;
          const double reach = ball.radius + radius;
          if (dot(d, d) < reach * reach) return false;
        }
      }
  return true;
}

std::int64_t inject(State& state, const Domain& domain, const Source& source, base::Seed seed,
                    std::int64_t due, std::int64_t& placed, double now) {
  std::vector<double> diameters;
  double largest = largest_of(state.particles), largest_new = 0;
  const auto stream = [&](std::int64_t number) {
    return base::Random(seed.derive(source.name).derive(static_cast<std::uint64_t>(number)));
  };
  for (auto k = placed; k < due; ++k) {
    auto random = stream(k);
    diameters.push_back(source.sizes.draw(random));
    largest_new = std::max(largest_new, room_of(diameters.back(), source.weight));
  }
  Placer placer(state.particles, domain, std::max(largest, largest_new));
  std::int64_t site = 0;
  for (const double diameter : diameters) {
    auto random = stream(placed);
    static_cast<void>(source.sizes.draw(random));
    const double radius = 0.5 * room_of(diameter, source.weight);
    const auto place = source.arrangement == Arrangement::random
                           ? random_place(placer, source.region, radius, random)
                           : lattice_place(placer, source.region, 1.001 * largest_new, radius, site);
    if (!place) break;
    placer.add(*place, radius);
    const double u = random.normal(), v = random.normal(), w = random.normal();
    state.particles.add({*place, source.velocity + source.scatter * Vec{u, v, w}, diameter, source.density,
                         state.next_id++, source.group, source.weight, now});
    ++placed;
    ++state.tally.added;
  }
  return due - placed;
}

std::unique_ptr<Effect> inlet(const Domain& domain, const Source& source, base::Seed seed,
                              std::int64_t& placed) {
  return std::make_unique<Inlet>(domain, source, seed, placed);
}
std::unique_ptr<Effect> outlet() { return std::make_unique<Outlet>(); }
std::unique_ptr<Effect> recirculation(const Domain& domain, const Body& region, const Vec& velocity,
                                      base::Seed seed) {
  return std::make_unique<Recirculation>(domain, region, velocity, seed);
}

}  // namespace elrom::scene
