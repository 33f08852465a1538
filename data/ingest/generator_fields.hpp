#pragma once
// Fields of a generated case from its inputs (equations in include/elrom/ingest/generate.hpp).

#include <array>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/math/matrix.hpp"
#include "generator_inputs.hpp"

namespace elrom::ingest {

/// Thread rule: const use from any thread.
class FieldGenerator {
 public:
  /// @param n_x cells in x of each plane of `mesh`; kept by reference
  FieldGenerator(const field::Mesh& mesh, std::size_t n_x, std::vector<GeneratorInput> inputs,
                 std::vector<field::FieldInfo> fields, double noise);
  /// (n_fields, n_cells), SI, inside the fields' physical bounds
  [[nodiscard]] MatrixF fields(const DesignPoint& point, base::Seed seed) const;

 private:
  struct State;
  [[nodiscard]] State state_of(const DesignPoint& point) const;
  void fill_profiles(State& state) const;
  [[nodiscard]] std::array<double, 9> cell(const State& state, std::size_t plane, std::size_t i,
                                           std::size_t j) const;
  void add_noise(std::span<float> values, const field::FieldInfo& field, base::Random random) const;
  [[nodiscard]] double tracer(const State& state, std::size_t number, std::size_t plane, std::size_t i,
                              std::size_t j) const;

  const field::Mesh& mesh_;
  std::size_t n_x_, n_y_;
  std::vector<GeneratorInput> inputs_;
  std::vector<field::FieldInfo> fields_;
  double noise_;
  double mean_annulus_ = 0;
  std::vector<double> across_x_, across_y_, height_;  //!< -1 to 1, (n_x), (n_y); share of height, (n_planes)
  std::vector<double> area_;                          //!< of each plane [m2], (n_planes)
  std::vector<std::vector<double>> near_x_, near_y_,
      near_z_;  //!< closeness to each inlet, (n_inputs, n_x / n_y / n_planes)
};

}  // namespace elrom::ingest
