#pragma once
// How spheres move through a time step, with their collisions: one seam, one implementation a collision
// model.
//
//   none              straight paths; spheres pass through each other
//   dem               soft spheres: contact forces, with history, in steps that the contact law asks for
//   helscm            swept: collisions at their exact times on straight paths, by a collision model
//   hel               parcels that feel each other as a continuum: stress of kinetic theory and friction;
//                     cells that are full let nobody in (stressed_parcels.cpp)
//   helscm_document   the source's: at the end of the step, spheres that overlap collide once with the mean
//                     of their partners. Its count depends on the step; kept to be compared with.
//
// In all of them the walls reflect at the exact time, except in dem with walls that are contacts.
//
// Thread rule: one thread calls; advance() uses threads of its own, and gives the same bits for any number.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "elrom/base/enum_names.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/kinetic_theory.hpp"
#include "elrom/scene/cell_grid.hpp"
#include "elrom/scene/particles.hpp"
#include "elrom/scene/residence.hpp"

namespace elrom::scene {

enum class Collisions { none, dem, hel, helscm, helscm_document };
inline constexpr base::EnumNames<Collisions, 5> collision_names{
    "collisions",
    {{Collisions::none, "none"},
     {Collisions::dem, "dem"},
     {Collisions::hel, "hel"},
     {Collisions::helscm, "helscm"},
     {Collisions::helscm_document, "helscm_document"}}};
enum class Walls { reflect, dem };
inline constexpr base::EnumNames<Walls, 2> wall_names{"walls",
                                                      {{Walls::reflect, "reflect"}, {Walls::dem, "dem"}}};

/// Of the velocity across a wall and along it.
struct WallLaw {
  Walls kind = Walls::reflect;
  double normal_restitution = 1, tangential_restitution = 1;
};

/// What happened since the scene began.
struct Tally {
  std::int64_t collisions = 0;  ///< of spheres with each other
  std::int64_t wall_hits = 0;   ///< contacts with walls, by their beginnings
  std::int64_t left = 0;        ///< spheres that passed an outlet
  std::int64_t returned = 0;    ///< of them, through recirculation
  std::int64_t added = 0;
  std::int64_t skipped = 0;             ///< collisions not computed, where spheres are jammed (helscm)
  std::vector<std::int64_t> by_groups;  ///< collisions of group a with b >= a: a n_groups + b
  std::vector<std::int64_t> wall_hits_by_group;
  std::vector<ResidenceTimes> residence;  ///< by group, of those that left
};

/// A scene at an instant.
struct State {
  Particles particles;
  double time = 0;  ///< s
  std::int64_t step = 0;
  std::int64_t next_id = 0;
  std::int32_t n_groups = 1;
  Vectors push;                       ///< acceleration by all forces in this step, m/s2; empty without forces
  std::vector<std::int32_t> leaving;  ///< that passed an outlet in this step, ascending
  std::vector<Sphere> waiting;        ///< left, and not back yet
  Tally tally;

  void set_groups(std::size_t n) {
    n_groups = static_cast<std::int32_t>(n);
    tally.by_groups.assign(n * n, 0);
    tally.wall_hits_by_group.assign(n, 0);
    tally.residence.assign(n, {});
  }
  void count_wall_hits(std::size_t group, std::int64_t hits) {
    tally.wall_hits += hits;
    tally.wall_hits_by_group[group] += hits;
  }
  void count_collision(std::size_t i, std::size_t j) {
    ++tally.collisions;
    const auto a = std::min(particles.group[i], particles.group[j]),
               b = std::max(particles.group[i], particles.group[j]);
    ++tally.by_groups[static_cast<std::size_t>(a * n_groups + b)];
  }
};

class Mover {
 public:
  virtual ~Mover() = default;
  /// @param dt s. @throws NumericalError where places or velocities are no numbers any more
  virtual void advance(State& state, double dt) = 0;
  /// Whether forces act all through the step, as state.push, rather than as kicks before and after it.
  [[nodiscard]] virtual bool takes_push() const { return false; }
  /// Spheres came, went, or were read from a checkpoint: lists of neighbours are made anew.
  virtual void forget() {}
  /// Brings all spheres and counts into `state`, in the order of their numbers, where several processes
  /// share them.
  virtual void gather(State&) {}
  [[nodiscard]] virtual std::size_t bytes() const { return 0; }
  /// For people: inner steps, contacts.
  [[nodiscard]] virtual std::string text() const { return {}; }
  virtual void save(io::TensorFile&) const {}
  virtual void load(const io::TensorFile&) {}
};

struct MoverSettings {
  Collisions collisions = Collisions::none;
  WallLaw walls;
  particle::ContactLaw law;
  /// For helscm and helscm_document.
  std::shared_ptr<const particle::CollisionModel> model = {};
  /// helscm: a sphere that collides again within this time loses no energy in it (Luding & McNamara 1998),
  /// so that spheres at rest on each other do not collide for ever, s
  double contact_time = 0;
  int steps_per_contact = 20;                 ///< dem
  std::shared_ptr<const CellGrid> grid = {};  ///< hel
  particle::GranularLaw granular = {};        ///< hel
  int n_threads = 1;
};

using MakeMover = std::function<std::unique_ptr<Mover>(const Domain& domain, const MoverSettings& settings)>;
/// @param domain lives longer
[[nodiscard]] std::unique_ptr<Mover> make_mover(const Domain& domain, const MoverSettings& settings);

}  // namespace elrom::scene
