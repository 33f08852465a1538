#pragma once
// field(cell) = mean(cell) + sum over modes of coefficient(inputs) * mode(cell): the form of every peer but
// the nearest case, and of the kernel smoother. Only the coefficients' predictor differs.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "elrom/model/coefficient_model.hpp"
#include "elrom/model/field_model.hpp"
#include "elrom/model/symmetry_fold.hpp"

namespace elrom::model {

/// Thread rule: const use from any number of threads, each with a Workspace of its own.
class PodModel final : public FieldModel {
 public:
  /// Tensors as they lie in a bundle: all modes of a plane side by side, so a plane is one piece of the file.
  struct Parts {
    std::string kind;  ///< as in study.toml: "linear", "pod_gp", ...
    io::Tensor mean;   //!< SI, (n_planes, n_columns) f32
    io::Tensor modes;  //!< (n_planes, n_modes, n_columns) f32; with a fold n_orbits for n_columns
    /// Where modes are zero in some planes: `modes` is (n_rows, n_columns), with the rows of plane p from
    /// first_row[p] to first_row[p + 1], and of each row the mode that it is. Else both are empty.
    std::vector<std::int32_t> first_row = {};  //!< (n_planes + 1)
    std::vector<std::int32_t> mode_of = {};    //!< (n_rows), those of a plane ascending
    //! SI, standard deviation of what the modes leave out, (n_planes, n_columns) f32; may be empty
    io::Tensor residual;
    std::shared_ptr<const CoefficientModel> coefficients;
    SymmetryFold fold = {};                        ///< empty: modes are stored for every column
    std::vector<std::int32_t> class_of_mode = {};  ///< class of the fold that each mode belongs to, (n_modes)
  };
  /// @throws InputError when shapes do not fit each other
  explicit PodModel(Parts parts, const std::string& where = "memory");

  [[nodiscard]] std::string kind() const override { return parts_.kind; }
  [[nodiscard]] std::size_t n_inputs() const override { return parts_.coefficients->n_inputs(); }
  [[nodiscard]] std::size_t n_planes() const override { return n_planes_; }
  [[nodiscard]] std::size_t n_columns() const override { return n_columns_; }
  [[nodiscard]] const CoefficientModel& coefficients() const { return *parts_.coefficients; }

  void predict(const Query& query, std::span<float> values, std::span<float> spread,
               Workspace& workspace) const override;
  [[nodiscard]] std::unique_ptr<FieldModel> without_case(std::size_t i_case) const override;
  /// As it would be with one case more, hyperparameters and modes kept; nullptr: no closed form for it.
  /// @param values of the case, SI, (n_planes * n_columns); what the modes do not span of them is lost
  [[nodiscard]] std::unique_ptr<FieldModel> with_case(std::span<const double> inputs,
                                                      std::span<const float> values) const;
  void save(io::TensorFile& file, const std::string& prefix) const override;

  /// Kinds that are stored in this form.
  [[nodiscard]] static const std::vector<std::string>& kinds();
  [[nodiscard]] static std::unique_ptr<FieldModel> load(const io::TensorFile& file, const std::string& prefix,
                                                        const Wanted& wanted);

 private:
  /// out += sum over modes of weight * mode, or of weight * mode^2 for spreads.
  /// @param weights (n_modes) @param out one plane, (n_columns)
  void add_modes(std::size_t plane, std::span<const float> weights, bool squares, std::span<float> out,
                 Workspace& workspace) const;

  /// The rows of `modes` that are of a plane.
  struct Rows {
    std::size_t first, n;
  };
  [[nodiscard]] Rows rows_of(std::size_t plane) const;
  [[nodiscard]] std::size_t mode_of(std::size_t row) const;
  void check_rows(const std::string& where) const;
  void add_modes_everywhere(std::span<const float> weights, std::span<float> out) const;
  [[nodiscard]] std::unique_ptr<FieldModel> of_other_cases(
      std::shared_ptr<const CoefficientModel> coefficients, const Eigen::VectorXd& mean_shift) const;

  Parts parts_;
  std::size_t n_planes_ = 0, n_columns_ = 0, n_modes_ = 0;
};

/// The planes where a mode is not zero.
struct ModePlanes {
  std::size_t first = 0, n = 0;
};

/// From matrices in cell order. @param mean (n_cells) @param modes (n_modes, n_cells)
/// @param residual (n_cells), may be empty @param n_columns divides n_cells
/// @param fold may be empty @param class_of_mode (n_modes) when it is not
/// @param planes_of_mode (n_modes), or empty: all planes
[[nodiscard]] std::unique_ptr<PodModel> make_pod_model(
    std::string kind, const Eigen::VectorXd& mean, const MatrixF& modes, const Eigen::VectorXd& residual,
    std::size_t n_columns, std::shared_ptr<const CoefficientModel> coefficients, SymmetryFold fold = {},
    std::vector<std::int32_t> class_of_mode = {}, std::span<const ModePlanes> planes_of_mode = {});

}  // namespace elrom::model
