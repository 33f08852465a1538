#pragma once
// Which planes of a mesh: all of them, or those of a list. What a command line,
// a prediction, a bundle's reader and a model's reader are told; Query and
// Predictor::planes() have the numbers that came of it for their mesh.

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <vector>

namespace elrom::field {

class Planes {
 public:
  Planes() = default;  ///< all
  /// @param numbers ascending, from 0, at least one. @throws UsageError
  Planes(std::vector<std::int32_t> numbers);
  Planes(std::initializer_list<std::int32_t> numbers) : Planes(std::vector(numbers)) {}
  /// Those numbers, in any order and more than once, and all from `open_from` on, whatever the mesh has.
  /// @throws UsageError when there is neither
  [[nodiscard]] static Planes listed(std::vector<std::int32_t> numbers,
                                     std::optional<std::int32_t> open_from = std::nullopt);

  [[nodiscard]] bool all() const { return numbers_.empty() && open_from_ == 0; }
  /// Whether a mesh of so many planes has them.
  [[nodiscard]] bool fit(std::size_t n_planes) const;
  /// Their numbers in a mesh of so many planes, ascending, at least one.
  /// @throws UsageError when the mesh lacks one of them, or there is none from the open end on
  [[nodiscard]] std::vector<std::int32_t> numbers(std::size_t n_planes) const;
  bool operator==(const Planes&) const = default;

 private:
  /// The highest that the mesh must have.
  [[nodiscard]] std::int32_t highest() const { return open_from_ ? *open_from_ : numbers_.back(); }

  std::vector<std::int32_t> numbers_;         //!< ascending, each once, all below open_from_
  std::optional<std::int32_t> open_from_{0};  //!< and every plane from here on
};

}  // namespace elrom::field
