#pragma once
// What the kernel method learns a field from: its symmetry classes, the derived inputs, and the symmetric
// part's first kernel, with its covariance and the forms of its inputs chosen. Internal to methods.

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "derived_inputs.hpp"
#include "elrom/math/kernel.hpp"
#include "elrom/math/standardiser.hpp"
#include "elrom/model/smoother_coefficients.hpp"
#include "fundamental_domain.hpp"
#include "symmetry_classes.hpp"

namespace elrom::methods {

/// Derived inputs of the cases and their scales.
struct KernelFeatures {
  DerivedInputs derived;
  math::Standardiser scaler;  // imbalances keep their zero: mean 0, root mean square as scale
  MatrixD z;

  [[nodiscard]] std::vector<Eigen::Index> of_class(std::size_t c) const {
    std::vector<Eigen::Index> found;
    for (std::size_t j = 0; j < derived.class_of.size(); ++j) {
      if (derived.class_of[j] == c) found.push_back(static_cast<Eigen::Index>(j));
    }
    return found;
  }
  [[nodiscard]] bool has(const std::string& name) const {
    return std::ranges::find(derived.map.features(), name, &model::Feature::name) !=
           derived.map.features().end();
  }
  [[nodiscard]] bool same_as(const model::FeatureMap& other) const {
    return std::ranges::equal(derived.map.features(), other.features(), {}, &model::Feature::name,
                              &model::Feature::name);
  }
};

/// Every class of a field over its scale, with what all of them are learned from.
struct FieldParts {
  std::vector<SymmetryClass> classes;
  FundamentalDomain domain;             // whose cells are meant by n_cells
  MatrixF symmetric;                    // departures of the symmetric class from its mean, (n_cases, n_cells)
  Eigen::VectorXd mean;                 // (n_cells)
  Eigen::VectorXd scales;               // of the cases, (n_cases)
  std::optional<model::Feature> scale;  // its logarithm; nothing: 0
  KernelFeatures features;
  std::optional<model::SmootherKernel> first;  // of the least leave-one-out error, all zones together
  const model::SmootherCoefficients* earlier = nullptr;  // of the same features

  /// @param scaled over a scale that the inputs give, where cases gain by it
  FieldParts(const field::FieldData& data, std::span<const std::size_t> cases, const FitContext& context,
             bool scaled);

  [[nodiscard]] bool nothing_to_learn() const {
    return symmetric.rows() < 3 || features.of_class(0).empty() || !(symmetric.squaredNorm() > 0);
  }
  /// The earlier kernel of a class in a zone; nullptr: none, or it knew other features.
  [[nodiscard]] const model::SmootherKernel* earlier_kernel(std::size_t c, std::size_t zone) const;
  /// Where the search for a zone's kernel begins: the earlier one, else that of all zones.
  [[nodiscard]] const model::SmootherKernel& start(std::size_t zone) const;
  /// One class of the cases, (n_cases, n_cells). @param cases those of the constructor
  [[nodiscard]] MatrixF part(const field::FieldData& data, std::span<const std::size_t> cases, std::size_t c,
                             int n_threads) const;
  /// The mean in all cells of the field.
  [[nodiscard]] Eigen::VectorXd whole_mean() const;
  /// The model of the field from that of the field over its scale.
  [[nodiscard]] std::unique_ptr<model::FieldModel> with_scale(std::unique_ptr<model::FieldModel> model) const;

 private:
  /// The covariance, and the form of each quantity that varies widely, of the least leave-one-out error: in
  /// some form the field is smoothest, and only the cases know in which.
  void choose(const field::CaseSet& cases, std::span<const std::size_t> rows, const Eigen::MatrixXd& gram);
  /// @param gram of `symmetric`
  void learn_scale(const field::CaseSet& cases, std::span<const std::size_t> rows,
                   const Eigen::MatrixXd& gram, int n_threads);
};

}  // namespace elrom::methods
