#pragma once
// Where spheres may be: the union of bodies with six plane sides (boxes and boxes whose top is narrower or
// wider than their bottom, turned as one likes). What is inside no body is wall.
//
// Each side is a wall, unless it is an outlet (spheres whose centre passes leave) or an opening (a side
// that a body shares with its neighbour). A body that reaches into its neighbour by more than a sphere's
// diameter needs no opening: there the deeper body counts. The distance to the wall is the largest over the
// bodies of the smallest over their sides; it grows by one metre a metre, is exact inside a convex domain,
// and falls short of the distance to an edge that points inwards.
//
// A domain without bodies is all of space. One whose single body is an upright box may be periodic.
// Thread rule: const use from any thread.

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/scene/particles.hpp"

namespace elrom::scene {

enum class SideKind : std::uint8_t { wall, outlet, opening };

struct Side {
  Vec normal;     ///< unit vector, into the body
  double offset;  ///< distance of p from the side: normal . p - offset
  SideKind kind = SideKind::wall;
  [[nodiscard]] double distance(const Vec& p) const { return dot(normal, p) - offset; }
};

/// Convex; sides x_low, x_high, y_low, y_high, z_low, z_high in this order.
struct Body {
  std::string name;
  std::array<Side, 6> sides;
  std::array<Vec, 8> corners;  ///< x fastest, z slowest
  [[nodiscard]] double volume() const;
};

/// A box with edges along the axes, tapered and turned after that.
struct BoxShape {
  std::string name;
  Vec low, high;  ///< m
  /// x and y of the top (z = high.z) where they differ from the bottom's: {x_low, y_low}, {x_high, y_high}, m
  std::optional<std::array<std::array<double, 2>, 2>> top = {};
  char turn_axis = 'z';
  double turn_angle = 0;  ///< rad, right-handed
  Vec turn_about = {};    ///< m
};
/// @throws UsageError for a box without volume
[[nodiscard]] Body body_of(const BoxShape& shape);

/// Shortest vectors between images.
struct Images {
  Vec period;  ///< m; 0: not periodic that way
  [[nodiscard]] bool any() const { return period.x > 0 || period.y > 0 || period.z > 0; }
  [[nodiscard]] Vec nearest(Vec d) const;
};

class Domain {
 public:
  Domain() = default;  ///< all of space
  /// @param openings, outlets "channel.z_high" @param periodic "x", "y", "z"
  /// @throws UsageError for a name that no body or side has, and for periodic sides of anything but one
  /// upright box
  explicit Domain(std::vector<Body> bodies, const std::vector<std::string>& outlets = {},
                  const std::vector<std::string>& openings = {},
                  const std::vector<std::string>& periodic = {});

  [[nodiscard]] const std::vector<Body>& bodies() const { return bodies_; }
  [[nodiscard]] bool unbounded() const { return bodies_.empty(); }
  [[nodiscard]] bool has_outlets() const { return has(SideKind::outlet); }
  [[nodiscard]] bool has_walls() const { return has(SideKind::wall); }
  [[nodiscard]] const Images& images() const { return images_; }
  /// The image inside the period.
  [[nodiscard]] Vec wrapped(Vec place) const;
  /// To the nearest wall or outlet, m; negative outside.
  [[nodiscard]] double distance(const Vec& place) const;
  /// To the nearest side of the body that it lies deepest in, openings too, m.
  [[nodiscard]] double room(const Vec& place) const;
  /// Whether a centre lies in some body, outlets' sides included.
  [[nodiscard]] bool contains(const Vec& place) const;
  /// Whether a centre is outside, behind an outlet.
  [[nodiscard]] bool has_left(const Vec& place) const;
  /// Corners of the upright box around everything. @param of bodies, at least one
  [[nodiscard]] Vec low() const;
  [[nodiscard]] Vec high() const;
  [[nodiscard]] const Body& body(
      const std::string& name) const;  ///< @throws UsageError with the nearest name

  /// @param name "box.z_low" @throws UsageError with the nearest name
  [[nodiscard]] const Side& named_side(const std::string& name) const;
  [[nodiscard]] double area_of(const Side& side) const;  ///< m2; of a side of this domain's

  /// Sides in the order of the bodies, six a body. @param side of this domain's
  [[nodiscard]] std::size_t number_of(const Side& side) const;
  /// A side's bit in a set of sides; sides whose numbers differ by 48, eight bodies on, share one.
  [[nodiscard]] std::uint64_t bit(const Side& side) const { return one << number_of(side) % n_bits; }
  /// Those of a set of sides that are nearer to a place than this, m.
  [[nodiscard]] std::uint64_t nearer(std::uint64_t sides, const Vec& place, double than) const;

  /// Where a centre on a straight path first comes within `radius` of a wall or passes an outlet.
  struct Exit {
    double time = std::numeric_limits<double>::infinity();
    const Side* side = nullptr;  ///< null: never
  };
  [[nodiscard]] Exit first_exit(const Vec& place, const Vec& velocity, double radius, double horizon) const;
  /// Walls that a sphere touches or overlaps: those of the body it lies deepest in. @return how many
  std::size_t touching(const Vec& place, double radius, std::array<const Side*, 6>& walls) const;

 private:
  static constexpr std::uint64_t one = 1;
  [[nodiscard]] bool has(SideKind kind) const;
  static constexpr std::size_t n_bits = 48;  // a double, as checkpoints hold it, has 53
  [[nodiscard]] std::size_t deepest(const Vec& place, double radius) const;

  std::vector<Body> bodies_;
  Images images_;
  Vec origin_;
};

}  // namespace elrom::scene
