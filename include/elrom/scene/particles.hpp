#pragma once
// The spheres of a scene: one array a quantity (structure of arrays), float64, SI.
//
// What a scene has no use for is not there: `spin` is empty unless the scene names rotation.
// Thread rule: plain data.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "elrom/particle/pairs.hpp"

namespace elrom::scene {

/// x, y, z of n vectors, each in an array of its own.
using Vectors = std::array<std::vector<double>, 3>;

struct Vec {
  double x = 0, y = 0, z = 0;
  Vec& operator+=(const Vec& b) { return x += b.x, y += b.y, z += b.z, *this; }
  Vec& operator-=(const Vec& b) { return x -= b.x, y -= b.y, z -= b.z, *this; }
  friend Vec operator+(Vec a, const Vec& b) { return a += b; }
  friend Vec operator-(Vec a, const Vec& b) { return a -= b; }
  friend Vec operator*(double s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
  bool operator==(const Vec&) const = default;
};
inline double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// For loops over the axes.
inline std::array<double, 3> array_of(const Vec& v) { return {v.x, v.y, v.z}; }
inline Vec get(const Vectors& v, std::size_t i) { return {v[0][i], v[1][i], v[2][i]}; }
inline void set(Vectors& v, std::size_t i, const Vec& a) { v[0][i] = a.x, v[1][i] = a.y, v[2][i] = a.z; }

/// A sphere alone, or a parcel: what an inlet adds and an outlet takes.
struct Sphere {
  Vec place, velocity;
  double diameter = 0, density = 0;
  std::int64_t id = 0;
  std::int32_t group = 0;
  double weight = 1;  ///< spheres that a parcel stands for
  double born = 0;    ///< s, when it came into the domain
};

struct Particles {
  Vectors place, velocity;       ///< m, m/s
  Vectors spin;                  ///< rad/s; empty without rotation
  std::vector<double> diameter;  ///< m
  std::vector<double> density;   ///< kg/m3
  std::vector<double> mass;      ///< kg, of all spheres of a parcel
  std::vector<std::int64_t> id;  ///< of its own, for as long as the scene runs
  std::vector<std::int32_t> group;
  std::vector<double> last_hit;  ///< s, when a sphere last collided; empty unless a collision model asks
  /// Spheres that each parcel stands for, all of its diameter; empty where all are spheres.
  std::vector<double> weight;
  std::vector<double> born;            ///< s, when each came; empty where none can leave
  std::vector<std::uint64_t> touched;  ///< walls that each touches, Domain::bit(); empty without walls
  bool rotates = false, remembers_hits = false, are_parcels = false, remembers_birth = false;
  bool remembers_walls = false;

  [[nodiscard]] std::size_t size() const { return id.size(); }
  /// At which two of them collide, m: a parcel of w spheres at d sqrt(w), so that between its collisions it
  /// flies as far as each of its spheres would, n/w pi (d sqrt(w))^2 = n pi d^2.
  [[nodiscard]] const std::vector<double>& contact_diameter() const {
    return are_parcels ? contact : diameter;
  }
  /// Of one sphere of a parcel, kg.
  [[nodiscard]] double sphere_mass(std::size_t i) const {
    return are_parcels ? mass[i] / weight[i] : mass[i];
  }
  [[nodiscard]] double volume(std::size_t i) const { return mass[i] / density[i]; }  ///< of its spheres, m3
  void add(const Sphere& sphere);
  /// Copy of one. @param i < size()
  [[nodiscard]] Sphere sphere(std::size_t i) const;
  /// Those for which keep[i] is 0 go; the others stay in their order.
  void keep_only(const std::vector<std::uint8_t>& keep);
  [[nodiscard]] std::size_t bytes() const;

  std::vector<double> contact;  ///< contact_diameter() of parcels
};

/// Spheres that a thread takes at a time.
inline constexpr std::size_t block_size = 1024;

/// Sums over all spheres.
[[nodiscard]] double mass_of(const Particles& particles);
[[nodiscard]] Vec momentum_of(const Particles& particles);           ///< kg m/s
[[nodiscard]] double kinetic_energy_of(const Particles& particles);  ///< of translation and rotation, J
[[nodiscard]] double greatest_speed_of(const Particles& particles);  ///< m/s

}  // namespace elrom::scene
