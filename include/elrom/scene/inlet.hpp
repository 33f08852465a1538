#pragma once
// Where spheres come from and go to: injection into regions without overlap, at once or over time; outlets;
// and recirculation, by which what left in a step comes back in the next, the same spheres with the same
// diameters.
//
// A sphere's diameter, place and velocity follow from the seed, its group and its number in it, so that
// they depend neither on threads nor on when a run was stopped and resumed.

#include <cstdint>
#include <optional>

#include "elrom/base/enum_names.hpp"
#include "elrom/base/random.hpp"
#include "elrom/scene/effect.hpp"

namespace elrom::scene {

enum class SizeSpread { value, normal, lognormal };
inline constexpr base::EnumNames<SizeSpread, 3> spread_names{
    "distribution",
    {{SizeSpread::value, "value"}, {SizeSpread::normal, "normal"}, {SizeSpread::lognormal, "lognormal"}}};

enum class Arrangement { random, lattice };
inline constexpr base::EnumNames<Arrangement, 2> arrangement_names{
    "arrangement", {{Arrangement::random, "random"}, {Arrangement::lattice, "lattice"}}};

/// Diameters, m.
struct Sizes {
  SizeSpread spread = SizeSpread::value;
  double mean = 0, deviation = 0;
  double smallest = 0,
         largest = std::numeric_limits<double>::infinity();  ///< what lies beyond is drawn again
  [[nodiscard]] double draw(base::Random& random) const;
};

struct Source {
  std::string name;
  std::int32_t group = 0;
  Sizes sizes;
  double density = 0;  ///< kg/m3
  std::int64_t number = 0;
  Body region;
  Arrangement arrangement = Arrangement::random;
  Vec velocity;        ///< m/s
  double scatter = 0;  ///< standard deviation of each component, m/s
  double over = 0;     ///< s: so long they come, evenly; 0: all are there at the start
  double weight = 1;   ///< spheres that each stands for; it takes the room of them all
};

/// Spheres so far in space, to ask where another one fits.
class Placer {
 public:
  Placer(const Particles& particles, const Domain& domain, double largest_diameter);
  ~Placer();
  /// Whether a sphere there lies inside the domain and touches no other.
  [[nodiscard]] bool fits(const Vec& place, double radius) const;
  void add(const Vec& place, double radius);

 private:
  struct Grid;
  const Domain& domain_;
  std::unique_ptr<Grid> grid_;
};

/// Adds what the source has due at a time. @param placed of it so far, updated @param now of their birth, s
/// @return how many found no room and are still due
std::int64_t inject(State& state, const Domain& domain, const Source& source, base::Seed seed,
                    std::int64_t due, std::int64_t& placed, double now = 0);

/// Injects over time. What finds no room comes later.
[[nodiscard]] std::unique_ptr<Effect> inlet(const Domain& domain, const Source& source, base::Seed seed,
                                            std::int64_t& placed);
/// Removes spheres that passed an outlet, and counts them.
[[nodiscard]] std::unique_ptr<Effect> outlet();
/// Keeps them waiting, and brings them back into a region as soon as there is room.
[[nodiscard]] std::unique_ptr<Effect> recirculation(const Domain& domain, const Body& region,
                                                    const Vec& velocity, base::Seed seed);

}  // namespace elrom::scene
