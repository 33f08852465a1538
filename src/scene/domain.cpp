#include "elrom/scene/domain.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::scene {
namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
constexpr std::array<const char*, 6> side_names{"x_low", "x_high", "y_low", "y_high", "z_low", "z_high"};
// Corners of each side (x fastest, z slowest), counterclockwise seen from inside.
constexpr std::array<std::array<int, 4>, 6> side_corners{
    {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}}};

Vec turned(const Vec& v, char axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  if (axis == 'x') return {v.x, c * v.y - s * v.z, s * v.y + c * v.z};
  if (axis == 'y') return {c * v.x + s * v.z, v.y, c * v.z - s * v.x};
  return {c * v.x - s * v.y, s * v.x + c * v.y, v.z};
}

Vec centre_of(const Body& body) {
  Vec sum;
  for (const auto& corner : body.corners) sum += 0.125 * corner;
  return sum;
}

// Through the corners of a flat side.
Side side_through(const Body& body, const std::array<int, 4>& at) {
  const auto corner = [&](int k) {
    return body.corners[static_cast<std::size_t>(at[static_cast<std::size_t>(k)])];
  };
  const Vec area = cross(corner(2) - corner(0), corner(3) - corner(1));
  const Vec normal = (1 / std::sqrt(dot(area, area))) * area;
  const double offset = 0.25 * (dot(normal, corner(0)) + dot(normal, corner(1)) + dot(normal, corner(2)) +
                                dot(normal, corner(3)));
  return {normal, offset};
}

// Twice the area of a side, across it.
Vec area(const Body& body, std::size_t side) {
  const auto corner = [&](std::size_t k) {
    return body.corners[static_cast<std::size_t>(side_corners[side][k])];
  };
  return cross(corner(2) - corner(0), corner(3) - corner(1));
}

// A wall, or an opening, as the centre of a sphere meets it.
double clearance(const Side& side, const Vec& place, double radius) {
  return side.distance(place) - (side.kind == SideKind::wall ? radius : 0);
}

double clearance(const Body& body, const Vec& place, double radius) {
  double least = endless;
  for (const auto& side : body.sides) least = std::min(least, clearance(side, place, radius));
  return least;
}

// When the centre leaves a body on its path, counted from `place`; now where it is outside and moves on
// outwards.
Domain::Exit exit_of(const Body& body, const Vec& place, const Vec& velocity, double radius) {
  Domain::Exit exit;
  for (const auto& side : body.sides) {
    const double rate = dot(side.normal, velocity);
    if (!(rate < 0)) continue;
    const double time = std::max(0.0, clearance(side, place, radius)) / -rate;
    if (time < exit.time) exit = {time, &side};
  }
  return exit;
}

std::size_t axis_of(const std::string& name) {
  const auto found = std::string("xyz").find(name);
  if (name.size() != 1 || found == std::string::npos)
    throw UsageError(
        Problem{.what = "unknown periodic direction", .found = "'" + name + "'", .expected = "x, y or z"});
  return found;
}

double& component(Vec& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

double wrap(double x, double origin, double period) {
  return period > 0 ? x - period * std::floor((x - origin) / period) : x;
}

double shortest(double d, double period) { return period > 0 ? d - period * std::nearbyint(d / period) : d; }

}  // namespace

double Body::volume() const {
  // Pyramids over the sides, from a corner.
  double sum = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    const Vec across = area(*this, k);
    const Vec corner = corners[static_cast<std::size_t>(side_corners[k][0])];
    sum += 0.5 * std::sqrt(dot(across, across)) * dot(sides[k].normal, corners[0] - corner) / 3;
  }
  return sum;
}

Body body_of(const BoxShape& shape) {
  const auto top = shape.top.value_or(
      std::array<std::array<double, 2>, 2>{{{shape.low.x, shape.low.y}, {shape.high.x, shape.high.y}}});
  const bool has_volume = shape.low.x < shape.high.x && shape.low.y < shape.high.y &&
                          shape.low.z < shape.high.z && top[0][0] < top[1][0] && top[0][1] < top[1][1];
  if (!has_volume)
    throw UsageError(Problem{.what = "a box without volume",
                             .where = "'" + shape.name + "'",
                             .expected = "low below high in x, y and z"});
  Body body{.name = shape.name, .sides = {}, .corners = {}};
  for (std::size_t k = 0; k < 8; ++k) {
    const std::array<double, 2> low = k < 4 ? std::array{shape.low.x, shape.low.y} : top[0];
    const std::array<double, 2> high = k < 4 ? std::array{shape.high.x, shape.high.y} : top[1];
    const Vec corner{(k & 1) != 0 ? high[0] : low[0], (k & 2) != 0 ? high[1] : low[1],
                     k < 4 ? shape.low.z : shape.high.z};
    body.corners[k] = shape.turn_about + turned(corner - shape.turn_about, shape.turn_axis, shape.turn_angle);
  }
  const Vec centre = centre_of(body);
  for (std::size_t k = 0; k < 6; ++k) {
    body.sides[k] = side_through(body, side_corners[k]);
    if (body.sides[k].distance(centre) > 0) continue;
    body.sides[k].normal = -1.0 * body.sides[k].normal;
    body.sides[k].offset = -body.sides[k].offset;
  }
  return body;
}

Vec Images::nearest(Vec d) const {
  return {shortest(d.x, period.x), shortest(d.y, period.y), shortest(d.z, period.z)};
}

Domain::Domain(std::vector<Body> bodies, const std::vector<std::string>& outlets,
               const std::vector<std::string>& openings, const std::vector<std::string>& periodic)
    : bodies_(std::move(bodies)) {
  const auto make = [&](const std::string& name, SideKind kind) {
    const_cast<Side&>(named_side(name)).kind = kind;
  };
  for (const auto& name : outlets) make(name, SideKind::outlet);
  for (const auto& name : openings) make(name, SideKind::opening);
  if (periodic.empty()) return;
  const auto upright = [](const Body& body) {
    return std::ranges::all_of(body.sides, [](const Side& side) {
      const Vec n = side.normal;
      return std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) > 1 - 1e-12;
    });
  };
  if (bodies_.size() != 1 || !upright(bodies_[0]))
    throw UsageError(Problem{.what = "periodic sides", .expected = "a domain of one upright box"});
  origin_ = low();
  const Vec size = high() - low();
  for (const auto& name : periodic) {
    const auto axis = axis_of(name);
    Vec lengths = size;
    component(images_.period, axis) = component(lengths, axis);
    for (const std::size_t k : {2 * axis, 2 * axis + 1}) bodies_[0].sides[k].offset = -endless;  // never met
  }
}

const Side& Domain::named_side(const std::string& name) const {
  const auto dot_at = name.rfind('.');
  std::vector<std::string> known;
  for (const auto& body : bodies_)
    for (std::size_t k = 0; k < 6; ++k) {
      known.push_back(body.name + "." + side_names[k]);
      if (known.back() == name) return body.sides[k];
    }
  throw UsageError(Problem{.what = "unknown side of the domain",
                           .found = "'" + name + "'",
                           .expected = dot_at == std::string::npos ? "box.side" : "",
                           .advice = base::name_advice(name, known)});
}

double Domain::area_of(const Side& side) const {
  for (const auto& body : bodies_)
    for (std::size_t k = 0; k < 6; ++k)
      if (&body.sides[k] == &side) return 0.5 * std::sqrt(dot(area(body, k), area(body, k)));
  return 0;
}

bool Domain::has(SideKind kind) const {
  return std::ranges::any_of(bodies_, [&](const Body& body) {
    return std::ranges::any_of(body.sides, [&](const Side& side) { return side.kind == kind; });
  });
}

std::size_t Domain::number_of(const Side& side) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto* first = bodies_[b].sides.data();
    if (&side >= first && &side < first + 6) return 6 * b + static_cast<std::size_t>(&side - first);
  }
  return 0;
}

std::uint64_t Domain::nearer(std::uint64_t sides, const Vec& place, double than) const {
  std::uint64_t left = 0;
  if (sides == 0) return left;
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    for (std::size_t k = 0; k < 6; ++k) {
      const auto mine = one << (6 * b + k) % n_bits;
      if ((sides & mine) != 0 && bodies_[b].sides[k].distance(place) < than) left |= mine;
    }
  return left;
}

Vec Domain::wrapped(Vec p) const {
  return {wrap(p.x, origin_.x, images_.period.x), wrap(p.y, origin_.y, images_.period.y),
          wrap(p.z, origin_.z, images_.period.z)};
}

double Domain::distance(const Vec& place) const {
  if (bodies_.empty()) return endless;
  double most = -endless;
  for (const auto& body : bodies_) {
    double least = endless;
    for (const auto& side : body.sides)
      if (side.kind != SideKind::opening || side.distance(place) < 0)
        least = std::min(least, side.distance(place));
    most = std::max(most, least);
  }
  return most;
}

double Domain::room(const Vec& place) const {
  return bodies_.empty() ? endless : clearance(bodies_[deepest(place, 0)], place, 0);
}

bool Domain::contains(const Vec& place) const {
  return bodies_.empty() ||
         std::ranges::any_of(bodies_, [&](const Body& body) { return clearance(body, place, 0) >= 0; });
}

bool Domain::has_left(const Vec& place) const {
  if (bodies_.empty() || contains(place)) return false;
  return std::ranges::any_of(bodies_[deepest(place, 0)].sides, [&](const Side& side) {
    return side.kind == SideKind::outlet && side.distance(place) < 0;
  });
}

Vec Domain::low() const {
  Vec low{endless, endless, endless};
  for (const auto& body : bodies_)
    for (const auto& c : body.corners)
      low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
  return low;
}

Vec Domain::high() const {
  Vec high{-endless, -endless, -endless};
  for (const auto& body : bodies_)
    for (const auto& c : body.corners)
      high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
  return high;
}

const Body& Domain::body(const std::string& name) const {
  std::vector<std::string> known;
  for (const auto& body : bodies_) {
    if (body.name == name) return body;
    known.push_back(body.name);
  }
  throw UsageError(
      Problem{.what = "unknown box", .found = "'" + name + "'", .advice = base::name_advice(name, known)});
}

std::size_t Domain::deepest(const Vec& place, double radius) const {
  std::size_t best = 0;
  double most = -endless;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const double depth = clearance(bodies_[k], place, radius);
    if (depth > most) most = depth, best = k;
  }
  return best;
}

Domain::Exit Domain::first_exit(const Vec& place, const Vec& velocity, double radius, double horizon) const {
  if (bodies_.empty()) return {};
  // A path leaves the domain where it leaves a body and no other goes on from there.
  const Body* body = &bodies_[deepest(place, radius)];
  double gone = 0;
  for (std::size_t turn = 0; turn <= 2 * bodies_.size(); ++turn) {
    auto exit = exit_of(*body, place + gone * velocity, velocity, radius);
    exit.time += gone;
    if (!(exit.time < horizon) || exit.side->kind == SideKind::outlet)
      return exit.time < horizon ? exit : Exit{};
    const Vec there = place + exit.time * velocity;
    const double slack = 1e-9 * radius;
    const Body* next = nullptr;
    double longest = 0;
    for (const auto& other : bodies_) {
      if (&other == body) continue;
      // Through an opening the neighbour's walls may be nearer than a radius: then they are met at once.
      const double room = exit.side->kind == SideKind::opening ? 0 : radius;
      if (clearance(other, there, room) < -slack) continue;
      const double goes_on = exit_of(other, there, velocity, radius).time;
      if (goes_on > longest || (exit.side->kind == SideKind::opening && next == nullptr))
        longest = goes_on, next = &other;
    }
    if (next == nullptr) return exit;
    gone = exit.time;
    body = next;
  }
  return {gone, &body->sides[0]};
}

std::size_t Domain::touching(const Vec& place, double radius, std::array<const Side*, 6>& walls) const {
  if (bodies_.empty()) return 0;
  std::size_t n = 0;
  for (const auto& side : bodies_[deepest(place, radius)].sides)
    if (side.kind == SideKind::wall && side.distance(place) < radius) walls[n++] = &side;
  return n;
}

}  // namespace elrom::scene
