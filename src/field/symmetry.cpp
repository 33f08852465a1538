#include "elrom/field/symmetry.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::field {

std::vector<double> Mirror::apply_to_inputs(std::span<const double> values) const {
  check(values.size() == input_from.size(), "a mirror of another schema");
  std::vector<double> mirrored(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    mirrored[i] = input_offset[i] + input_sign[i] * values[static_cast<std::size_t>(input_from[i])];
  }
  return mirrored;
}

double Mirror::field_sign(Parity parity) const {
  const auto turned = [&](char axis) { return axes.find(axis) != std::string::npos; };
  const bool turns =
      (parity == Parity::vector_x && turned('x')) || (parity == Parity::vector_y && turned('y'));
  return turns ? -1.0 : 1.0;
}

namespace {

// What each '*' of `pattern` stands for in `name` (leftmost match); nullopt: no match.
std::optional<std::vector<std::string>> capture(const std::string& name, const std::string& pattern) {
  const auto parts = base::split(pattern, '*');
  if (!base::matches(name, pattern)) return std::nullopt;
  std::vector<std::string> stars;
  std::size_t at = parts.front().size();
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const bool last = k + 1 == parts.size();
    const auto next = last ? name.size() - parts[k].size() : name.find(parts[k], at);
    stars.push_back(name.substr(at, next - at));
    at = next + parts[k].size();
  }
  return stars;
}

// The name that `other` gives for what the stars of `pattern` stand for in `name`; nullopt: no match.
std::optional<std::string> partner(const std::string& name, const std::string& pattern,
                                   const std::string& other) {
  const auto stars = capture(name, pattern);
  if (!stars) return std::nullopt;
  const auto parts = base::split(other, '*');
  std::string result = parts.front();
  for (std::size_t k = 1; k < parts.size(); ++k) result += (*stars)[k - 1] + parts[k];
  return result;
}

void expect_like_patterns(const std::string& a, const std::string& b, const std::string& where) {
  const auto stars = std::count(a.begin(), a.end(), '*');
  const bool marks = (a + b).find('?') != std::string::npos;
  if (stars >= 1 && stars == std::count(b.begin(), b.end(), '*') && !marks) return;
  throw InputError({.what = "patterns '" + a + "' and '" + b + "'",
                    .where = where,
                    .expected = "the same number of '*' in both, one or more"});
}

// Partner of every input, applying every pair of patterns in
// turn (left-right and front-rear may be declared apart).
std::vector<std::int32_t> pair_inputs(const MirrorDeclaration& declaration, const InputSchema& schema) {
  std::vector<std::int32_t> from(schema.size());
  std::iota(from.begin(), from.end(), 0);
  const auto names = schema.names();
  const auto where = "mirror '" + declaration.name + "'";
  for (const auto& [a, b] : declaration.swap) {
    expect_like_patterns(a, b, where);
    bool used = false;
    for (std::size_t i = 0; i < names.size(); ++i) {
      auto other = partner(names[i], a, b);
      if (!other) other = partner(names[i], b, a);
      if (!other) continue;
      used = true;
      const auto found = std::find(names.begin(), names.end(), *other);
      if (found == names.end()) {
        throw InputError({.what = "'" + names[i] + "' has no partner '" + *other + "'",
                          .where = where,
                          .advice = base::name_advice(*other, names)});
      }
      from[i] = static_cast<std::int32_t>(found - names.begin());
    }
    if (!used)
      throw InputError({.what = "no boundary condition matches '" + a + "' or '" + b + "'", .where = where});
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (from[static_cast<std::size_t>(from[i])] == static_cast<std::int32_t>(i)) continue;
    throw InputError({.what = "'" + names[i] + "' has two partners", .where = where});
  }
  return from;
}

std::array<double, 3> row_of(const MatrixD& table, std::size_t i) {
  const auto row = static_cast<Eigen::Index>(i);
  return {table(row, 0), table(row, 1), table(row, 2)};
}

// Cells of one plane by position, found through a grid so fine that no two cells share a box.
class PlaneIndex {
 public:
  PlaneIndex(const Mesh& mesh, std::size_t plane, double tolerance) : tolerance_(tolerance) {
    for (std::size_t c = 0; c < mesh.n_columns; ++c) {
      const auto p = row_of(mesh.centre, plane * mesh.n_columns + c);
      cells_.emplace(box(p), std::pair(p, c));
    }
  }
  [[nodiscard]] std::optional<std::size_t> find(const std::array<double, 3>& p) const {
    const auto middle = box(p);
    for (std::int64_t i = -1; i <= 1; ++i) {
      for (std::int64_t j = -1; j <= 1; ++j) {
        const auto [begin, end] = cells_.equal_range({middle[0] + i, middle[1] + j});
        for (auto it = begin; it != end; ++it) {
          const auto& q = it->second.first;
          if (std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]) <= tolerance_) return it->second.second;
        }
      }
    }
    return std::nullopt;
  }

 private:
  using Box = std::array<std::int64_t, 2>;
  [[nodiscard]] Box box(const std::array<double, 3>& p) const {
    return {std::llround(p[0] / (4 * tolerance_)), std::llround(p[1] / (4 * tolerance_))};
  }
  double tolerance_;
  std::multimap<Box, std::pair<std::array<double, 3>, std::size_t>> cells_;
};

std::vector<std::int32_t> pair_cells(const MirrorDeclaration& declaration, const Mesh& mesh) {
  const Eigen::Index axis = declaration.axis == 'x' ? 0 : 1;
  const double low = mesh.centre.col(axis).minCoeff(), high = mesh.centre.col(axis).maxCoeff();
  const double extent = (mesh.centre.colwise().maxCoeff() - mesh.centre.colwise().minCoeff()).maxCoeff();
  const double tolerance = std::max(1e-6 * extent, 1e-12);
  std::vector<std::int32_t> from(mesh.n_cells());
  for (std::size_t plane = 0; plane < mesh.n_planes; ++plane) {
    const PlaneIndex index(mesh, plane, tolerance);
    for (std::size_t c = 0; c < mesh.n_columns; ++c) {
      const auto cell = plane * mesh.n_columns + c;
      auto image = row_of(mesh.centre, cell);
      image[static_cast<std::size_t>(axis)] = low + high - image[static_cast<std::size_t>(axis)];
      const auto found = index.find(image);
      if (!found) {
        throw InputError({.what = "the mesh is not symmetric in " + std::string(1, declaration.axis),
                          .where = "mirror '" + declaration.name + "', plane " + std::to_string(plane) +
                                   ", column " + std::to_string(c)});
      }
      from[cell] = static_cast<std::int32_t>(plane * mesh.n_columns + *found);
    }
  }
  return from;
}

Mirror identity(std::size_t n_inputs, std::size_t n_cells) {
  Mirror mirror{.name = "identity", .axes = ""};
  mirror.input_from.resize(n_inputs);
  std::iota(mirror.input_from.begin(), mirror.input_from.end(), 0);
  mirror.input_sign.assign(n_inputs, 1);
  mirror.input_offset.assign(n_inputs, 0);
  mirror.cell_from.resize(n_cells);
  std::iota(mirror.cell_from.begin(), mirror.cell_from.end(), 0);
  return mirror;
}

// First `a`, then `b`.
Mirror product(const Mirror& a, const Mirror& b) {
  auto both = identity(a.input_from.size(), a.cell_from.size());
  both.name = a.name + " + " + b.name;
  for (const char axis : {'x', 'y'}) {
    const auto has = [axis](const Mirror& m) { return m.axes.find(axis) != std::string::npos; };
    if (has(a) != has(b)) both.axes += axis;
  }
  for (std::size_t i = 0; i < both.input_from.size(); ++i) {
    const auto k = static_cast<std::size_t>(b.input_from[i]);
    both.input_from[i] = a.input_from[k];
    both.input_sign[i] = b.input_sign[i] * a.input_sign[k];
    both.input_offset[i] = b.input_offset[i] + b.input_sign[i] * a.input_offset[k];
  }
  for (std::size_t c = 0; c < both.cell_from.size(); ++c) {
    both.cell_from[c] = a.cell_from[static_cast<std::size_t>(b.cell_from[c])];
  }
  return both;
}

bool same(const Mirror& a, const Mirror& b) {
  return a.axes == b.axes && a.input_from == b.input_from && a.input_sign == b.input_sign &&
         a.input_offset == b.input_offset && a.cell_from == b.cell_from;
}

}  // namespace

std::vector<Mirror> symmetry_group(const std::vector<Mirror>& mirrors, std::size_t n_inputs,
                                   std::size_t n_cells) {
  constexpr std::size_t most = 8;
  std::vector<Mirror> group{identity(n_inputs, n_cells)};
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (const auto& mirror : mirrors) {
      check(mirror.input_from.size() == n_inputs && mirror.cell_from.size() == n_cells,
            "a mirror of another schema or mesh");
      const auto next = i == 0 ? mirror : product(group[i], mirror);
      if (std::any_of(group.begin(), group.end(), [&](const Mirror& m) { return same(m, next); })) continue;
      if (group.size() == most)
        throw InputError("the declared mirrors do not form a small group; declare at most one per axis");
      group.push_back(next);
    }
  }
  return group;
}

Mirror resolve(const MirrorDeclaration& declaration, const InputSchema& schema, const Mesh& mesh) {
  if (declaration.axis != 'x' && declaration.axis != 'y') {
    throw InputError({.what = "axis of mirror '" + declaration.name + "'",
                      .found = std::string(1, declaration.axis),
                      .expected = "x or y"});
  }
  auto mirror = identity(schema.size(), 0);
  mirror.name = declaration.name;
  mirror.axes = declaration.axis;
  mirror.input_from = pair_inputs(declaration, schema);
  for (const auto& name : declaration.complement) {
    const auto i = schema.index_of(name);
    mirror.input_sign[i] = -1;
    mirror.input_offset[i] = 1;
  }
  mirror.cell_from = pair_cells(declaration, mesh);
  return mirror;
}

}  // namespace elrom::field
