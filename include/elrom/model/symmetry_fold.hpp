#pragma once
// Modes of a mirror-symmetric field kept once: columns that mirrors exchange hold the same value up to a
// sign, so a mode of a symmetry class is stored for one column of each orbit. With two mirrors this is a
// quarter of the bytes and of the work.

#include <span>
#include <string>
#include <vector>

#include "elrom/field/symmetry.hpp"
#include "elrom/io/tensor_file.hpp"

namespace elrom::model {

/// Thread rule: const use from any thread.
class SymmetryFold {
 public:
  /// No folding: empty() is true.
  SymmetryFold() = default;
  /// @param mirrors of the mesh; must map every plane to itself in the same way, else the fold is empty
  /// @param class_signs what each class becomes under each mirror, +1 or -1, (n_classes) of (mirrors.size())
  SymmetryFold(const std::vector<field::Mirror>& mirrors, field::Parity parity,
               const std::vector<std::vector<int>>& class_signs, std::size_t n_planes, std::size_t n_columns);

  [[nodiscard]] bool empty() const { return orbit_.empty(); }
  [[nodiscard]] std::size_t n_columns() const { return orbit_.size(); }
  [[nodiscard]] std::size_t n_orbits() const { return n_orbits_; }
  /// The column that each orbit is stored for, ascending, (n_orbits).
  [[nodiscard]] std::span<const std::int32_t> stored_columns() const { return first_; }
  [[nodiscard]] std::size_t n_classes() const { return sign_.size() == 0 ? 0 : sign_.shape()[0]; }

  /// All columns of each orbit, ascending.
  [[nodiscard]] std::vector<std::vector<std::size_t>> orbits() const;

  /// The stored column of each orbit, out of a mode's plane.
  /// @param column (n_columns) @param stored (n_orbits)
  void pick(std::span<const float> column, std::span<float> stored) const;
  /// column[j] += sign(class, j) * stored[orbit(j)]. @param stored (n_orbits) @param column (n_columns)
  void add(std::size_t i_class, std::span<const float> stored, std::span<float> column) const;
  /// The same for squares, which have no sign: columns where the class must vanish stay.
  void add_squares(std::size_t i_class, std::span<const float> stored, std::span<float> column) const;

  void save(io::TensorFile& file, const std::string& prefix) const;
  /// Empty when the file has none there. @throws InputError for sizes that do not fit, an orbit or a sign out
  /// of range
  [[nodiscard]] static SymmetryFold load(const io::TensorFile& file, const std::string& prefix);

 private:
  std::vector<std::int32_t> orbit_;  //!< stored column that each column takes its value from, (n_columns)
  std::vector<std::int32_t> first_;  //!< the column that each orbit is stored for, (n_orbits)
  io::Tensor sign_;                  //!< -1, 0 or 1, (n_classes, n_columns) f32
  std::size_t n_orbits_ = 0;
};

}  // namespace elrom::model
