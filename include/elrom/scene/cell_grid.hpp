#pragma once
// A Cartesian grid over a domain, cut by its walls: what spheres carry is spread over its cells or faces and
// read back by the same weights, so that what one side gives the other gets, to rounding.
//
// A cell is open where at least half of it lies inside the domain. Faces are staggered: face a of cell c is
// that on its low side along axis a; it is open where both of its cells are, or where gas comes in or goes
// out there; where one of them is, it is a wall, on which gas stands. Weights are trilinear, of cells among
// those that are open, of faces among those of open cells, with a sum of 1.
//
// Thread rule: const use from any thread.

#include <cstdint>

#include "elrom/scene/domain.hpp"

namespace elrom::scene {

/// What is left to the gas in a cell at least, however many parcels claim it.
inline constexpr double least_voidage = 0.3;

/// Of a place: cells, or faces along an axis, with their weights.
struct Shares {
  std::array<std::int32_t, 8> of;
  std::array<double, 8> weight;
};

/// Of a quantity by faces along each axis, what there is at a place. @param faces those around it
[[nodiscard]] inline Vec read(const Vectors& values, const std::array<Shares, 3>& faces) {
  std::array<double, 3> sum{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t k = 0; k < 8; ++k)
      sum[a] += faces[a].weight[k] * values[a][static_cast<std::size_t>(faces[a].of[k])];
  return {sum[0], sum[1], sum[2]};
}

class CellGrid {
 public:
  static constexpr std::int32_t none = -1;

  /// @param size of a cell, m, made a little smaller so that cells fill the box around the domain
  /// @throws UsageError for a domain without bounds, and for more than 5 million cells
  CellGrid(const Domain& domain, const Vec& size);

  [[nodiscard]] std::size_t size() const { return open_.size(); }  ///< cells, closed ones too
  [[nodiscard]] const std::array<std::size_t, 3>& count() const { return count_; }
  [[nodiscard]] const std::array<double, 3>& step() const { return step_; }  ///< m
  [[nodiscard]] double volume() const { return step_[0] * step_[1] * step_[2]; }
  [[nodiscard]] bool is_open(std::size_t cell) const { return open_[cell] != 0; }
  [[nodiscard]] double space(std::size_t cell) const {
    return space_[cell];
  }  ///< of it inside the domain, m3
  [[nodiscard]] Vec centre(std::size_t cell) const;
  /// The cell that a place lies in, or the open one nearest to that.
  [[nodiscard]] std::size_t cell_at(const Vec& place) const;
  /// Of a cell along an axis; none beyond the grid. @param side -1, 1
  [[nodiscard]] std::int32_t neighbour(std::size_t cell, std::size_t axis, int side) const;

  [[nodiscard]] Shares cells(const Vec& place) const;
  /// Faces are numbered as their cells, those of the high end in a layer of their own behind.
  [[nodiscard]] Shares faces(const Vec& place, std::size_t axis) const { return faces(place, axis, wall); }
  /// Without walls: of what goes through faces.
  [[nodiscard]] Shares open_faces(const Vec& place, std::size_t axis) const {
    return faces(place, axis, inside);
  }
  [[nodiscard]] std::size_t face_count(std::size_t axis) const { return faces_[axis].size(); }
  /// The face between a cell and its neighbour. @param side -1, 1
  [[nodiscard]] std::size_t face(std::size_t cell, std::size_t axis, int side) const;
  [[nodiscard]] bool is_face_open(std::size_t axis, std::size_t face) const {
    return faces_[axis][face] >= inside;
  }
  /// An opening in a wall.
  void open_face(std::size_t axis, std::size_t face) { faces_[axis][face] = opening; }
  /// Between the centres of its cells; of walls and openings half of that, m3.
  [[nodiscard]] double face_volume(std::size_t axis, std::size_t face) const {
    return faces_[axis][face] == inside ? volume() : 0.5 * volume();
  }
  [[nodiscard]] std::size_t bytes() const;

 private:
  using Index = std::array<std::size_t, 3>;
  static constexpr std::uint8_t beyond = 0, wall = 1, inside = 2, opening = 3;  // of a face
  [[nodiscard]] Shares faces(const Vec& place, std::size_t axis, std::uint8_t least) const;
  [[nodiscard]] Index index(std::size_t cell) const;
  [[nodiscard]] std::size_t cell(const Index& at) const {
    return at[0] + count_[0] * (at[1] + count_[1] * at[2]);
  }
  [[nodiscard]] double space_of(const Domain& domain, std::size_t cell) const;
  void find_hosts();

  std::array<double, 3> low_{}, step_{};
  Index count_{1, 1, 1};
  std::array<bool, 3> periodic_{};
  std::vector<std::uint8_t> open_;
  std::vector<double> space_;
  std::vector<std::int32_t> host_;  // open cell nearest to each
  std::array<std::vector<std::uint8_t>, 3> faces_;
};

}  // namespace elrom::scene
