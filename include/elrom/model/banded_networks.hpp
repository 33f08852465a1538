#pragma once
// The source's model of one field: the columns are shared out among submodels ("bands") by how hard they are
// to learn; each submodel is one multilayer perceptron, built several times, that maps boundary conditions
// and a plane to the values of its columns in that plane.

#include <cstdint>
#include <string>
#include <vector>

#include "elrom/model/field_model.hpp"
#include "elrom/model/network.hpp"
#include "elrom/model/plane_encoding.hpp"
#include "elrom/model/scaler.hpp"
#include "elrom/model/target_transform.hpp"

namespace elrom::model {

struct Submodel {
  std::string name;                   ///< "0.1 to 0.2": the band
  std::vector<std::int32_t> columns;  //!< column of each network output, ascending, (n_outputs)
  //! 1 where it answers for a cell, (n_planes, n_outputs); empty: in all planes
  std::vector<std::uint8_t> mask;
  std::vector<Network> builds;  ///< inputs: scaled boundary conditions, then the plane's encoding
  std::vector<double> scores;   //!< validation MSE of each build, standardised units, (n_builds)

  [[nodiscard]] std::size_t best() const;               ///< the build of the lowest score
  [[nodiscard]] bool answers(std::size_t plane) const;  ///< for any cell of the plane
  [[nodiscard]] bool answers(std::size_t plane, std::size_t i_output) const {
    return mask.empty() || mask[plane * columns.size() + i_output] != 0;
  }
};

enum class Combination { mean, best };

/// The mean is taken over the builds' values in physical units, after the transform is undone: it is the
/// value with the least expected squared error in the unit that reports use. The spread is the standard
/// deviation over the builds (n - 1 in the denominator; 0 for one build).
class BandedNetworks : public FieldModel {
 public:
  struct Parts {
    std::size_t n_columns = 0;
    InputScaler inputs;
    PlaneEncoding planes;
    TargetTransform transform;
    OutputScaler outputs;
    std::vector<Submodel> submodels;
    Combination combination = Combination::mean;
    field::Planes loaded_planes;  ///< the planes it answers for
  };
  /// @throws InputError when the parts do not fit, or a cell is answered by no submodel or by several
  explicit BandedNetworks(Parts parts);

  [[nodiscard]] std::string kind() const override { return "networks"; }
  [[nodiscard]] std::size_t n_inputs() const override { return parts_.inputs.size(); }
  [[nodiscard]] std::size_t n_planes() const override { return parts_.planes.n_planes; }
  [[nodiscard]] std::size_t n_columns() const override { return parts_.n_columns; }
  [[nodiscard]] const Parts& parts() const { return parts_; }
  void predict(const Query& query, std::span<float> values, std::span<float> spread,
               Workspace& workspace) const override;

  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<FieldModel> load(const io::TensorFile& file, const std::string& prefix,
                                                        const Wanted& wanted);
  /// The same model with weights in float16.
  [[nodiscard]] BandedNetworks halved() const;

 private:
  struct Request;
  void predict_submodel(const Submodel& submodel, const Request& request, Workspace& workspace) const;
  void predict_rows(const Submodel& submodel, const Request& request, std::span<const std::size_t> rows,
                    Workspace& workspace) const;
  struct RowOutputs;
  void scatter_row(const Submodel& submodel, const Request& request, std::size_t i_row,
                   const RowOutputs& outputs) const;

  Parts parts_;
  MatrixF encodings_;  //!< (n_planes, planes.size())
};

}  // namespace elrom::model
