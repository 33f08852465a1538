#pragma once
// Field models made of field models: a weighted sum, a multiple, the average over mirror images, and a field
// from its symmetric part.

#include <memory>
#include <string>
#include <vector>

#include "elrom/field/symmetry.hpp"
#include "elrom/model/feature_map.hpp"
#include "elrom/model/field_model.hpp"
#include "elrom/model/symmetry_fold.hpp"

namespace elrom::model {

/// sum of weight_i * model_i, with weights that may differ from column to column; the spreads add up with the
/// same weights (their errors are taken as fully correlated). Thread rule: const use from any number of
/// threads, each with a Workspace of its own.
class BlendModel final : public FieldModel {
 public:
  struct Member {
    std::vector<double> weights;  ///< (n_columns), or one for all columns
    std::shared_ptr<const FieldModel> model;
  };
  /// @throws InputError without parts, or when their inputs, planes, columns or numbers of weights do not fit
  explicit BlendModel(std::vector<Member> parts, const std::string& where = "memory");

  [[nodiscard]] std::string kind() const override { return "blend"; }
  [[nodiscard]] std::size_t n_inputs() const override { return parts_.front().model->n_inputs(); }
  [[nodiscard]] std::size_t n_planes() const override { return parts_.front().model->n_planes(); }
  [[nodiscard]] std::size_t n_columns() const override { return parts_.front().model->n_columns(); }
  void predict(const Query& query, std::span<float> values, std::span<float> spread,
               Workspace& workspace) const override;
  /// The parts that have a closed form are without the case, the others as they are; nullptr: none has.
  [[nodiscard]] std::unique_ptr<FieldModel> without_case(std::size_t i_case) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<FieldModel> load(const io::TensorFile& file, const std::string& prefix,
                                                        const Wanted& wanted);
  [[nodiscard]] const std::vector<Member>& members() const { return parts_; }

 private:
  std::vector<Member> parts_;
};

/// What a model answers, values and spread, times exp(logarithm of the inputs): a field over a scale that the
/// inputs give, such as a pressure over the weight of the solids. Thread rule: as above.
class ScaledModel final : public FieldModel {
 public:
  /// @param logarithm of the scale, one feature. @throws InputError for more, or for other inputs
  ScaledModel(FeatureMap logarithm, std::shared_ptr<const FieldModel> model,
              const std::string& where = "memory");

  /// That of the model: people ask how the answer was found.
  [[nodiscard]] std::string kind() const override { return model_->kind(); }
  [[nodiscard]] std::size_t n_inputs() const override { return model_->n_inputs(); }
  [[nodiscard]] std::size_t n_planes() const override { return model_->n_planes(); }
  [[nodiscard]] std::size_t n_columns() const override { return model_->n_columns(); }
  void predict(const Query& query, std::span<float> values, std::span<float> spread,
               Workspace& workspace) const override;
  [[nodiscard]] std::unique_ptr<FieldModel> without_case(std::size_t i_case) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<FieldModel> load(const io::TensorFile& file, const std::string& prefix,
                                                        const Wanted& wanted);
  [[nodiscard]] const std::shared_ptr<const FieldModel>& model() const { return model_; }
  [[nodiscard]] const FeatureMap& logarithm() const { return logarithm_; }
  /// @param inputs SI, (n_inputs)
  [[nodiscard]] float scale(std::span<const double> inputs) const;

 private:
  FeatureMap logarithm_;
  std::shared_ptr<const FieldModel> model_;
};

/// Name of the scale that the field, or the first part of a blend that has one, is learned over: "all
/// gas^0.94 solids_d50^-0.23"; empty: none.
[[nodiscard]] std::string scale_of(const FieldModel& model);

/// The model as it would be with one case more (PodModel::with_case); of a blend, the parts
/// that have a closed form. nullptr: nothing of it has.
[[nodiscard]] std::unique_ptr<FieldModel> with_case(const FieldModel& model, std::span<const double> inputs,
                                                    std::span<const float> values);

/// Mean over the symmetry group of g^-1(model(g(inputs))): exactly symmetric, and less noisy than the model
/// alone. Mirrors keep every cell in its plane. Thread rule: as above.
class MirrorModel final : public FieldModel {
 public:
  /// @param group all elements, as field::symmetry_group gives them
  /// @throws InputError for an image that takes cells to another plane
  MirrorModel(std::shared_ptr<const FieldModel> model, const std::vector<field::Mirror>& group,
              field::Parity parity, std::size_t n_planes);

  [[nodiscard]] std::string kind() const override { return "mirror"; }
  [[nodiscard]] std::size_t n_inputs() const override { return model_->n_inputs(); }
  [[nodiscard]] std::size_t n_planes() const override { return model_->n_planes(); }
  [[nodiscard]] std::size_t n_columns() const override { return model_->n_columns(); }
  void predict(const Query& query, std::span<float> values, std::span<float> spread,
               Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<FieldModel> load(const io::TensorFile& file, const std::string& prefix,
                                                        const Wanted& wanted);

 private:
  struct Image {
    io::Tensor input_from;  //!< (n_inputs) i32: mirrored[i] = offset[i] + sign[i] * inputs[input_from[i]]
    io::Tensor input_sign, offset;  //!< (n_inputs) f64
    io::Tensor column_from;  //!< (n_planes, n_columns) i32, or (1, n_columns) when every plane has the same
    float field_sign = 1;
  };
  MirrorModel() = default;
  void add_image(const Image& image, const Query& query, std::span<float> values, std::span<float> spread,
                 Workspace& workspace) const;

  std::shared_ptr<const FieldModel> model_;
  std::vector<Image> images_;
};

/// A mirror-symmetric field: its symmetric part from a model of one column of each orbit, which is asked with
/// the symmetric parts of the inputs, and its asymmetry from another model. Their spreads add up.
/// Thread rule: as above.
class UnfoldedModel final : public FieldModel {
 public:
  /// @param symmetric part of each input, as many as the model takes
  /// @param fold of the mesh, the symmetric class first; empty: the model has all columns
  /// @param asymmetry in all columns; nullptr: none
  /// @throws InputError when these do not fit together
  UnfoldedModel(FeatureMap symmetric, SymmetryFold fold, std::shared_ptr<const FieldModel> model,
                std::shared_ptr<const FieldModel> asymmetry, const std::string& where = "memory");

  /// That of the symmetric part: people ask how the answer was found.
  [[nodiscard]] std::string kind() const override { return model_->kind(); }
  [[nodiscard]] std::size_t n_inputs() const override { return symmetric_.n_inputs(); }
  [[nodiscard]] std::size_t n_planes() const override { return model_->n_planes(); }
  [[nodiscard]] std::size_t n_columns() const override {
    return fold_.empty() ? model_->n_columns() : fold_.n_columns();
  }
  void predict(const Query& query, std::span<float> values, std::span<float> spread,
               Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<FieldModel> load(const io::TensorFile& file, const std::string& prefix,
                                                        const Wanted& wanted);
  [[nodiscard]] const std::shared_ptr<const FieldModel>& model() const { return model_; }
  [[nodiscard]] const SymmetryFold& fold() const { return fold_; }

 private:
  void predict_symmetric(const Query& query, std::span<float> values, std::span<float> spread,
                         Workspace& workspace) const;

  FeatureMap symmetric_;
  SymmetryFold fold_;
  std::shared_ptr<const FieldModel> model_, asymmetry_;
};

}  // namespace elrom::model
