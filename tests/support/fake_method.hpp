#pragma once
// A method whose cross-validated errors are given, and error patterns for it.

#include <optional>
#include <string>
#include <string_view>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/random.hpp"
#include "elrom/methods/method.hpp"
#include "elrom/methods/peers.hpp"

namespace elrom::test {

/// Predicts the truth plus a given error pattern; fits to the nearest peer, which nobody asks.
class FakeMethod final : public methods::Method {
 public:
  FakeMethod(std::string name, MatrixF errors) : name_(std::move(name)), errors_(std::move(errors)) {}
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::string key(const std::string&) const override {
    return base::digest_of_members(name_, errors_);
  }
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const methods::FitContext& context) const override {
    return methods::make_peer("nearest")->fit(data, cases, context);
  }
  [[nodiscard]] MatrixF predict_folds(const field::FieldData& data, const methods::Folds& folds,
                                      std::span<const std::size_t> wanted,
                                      const methods::FitContext& context) const override {
    known.reset();
    if (context.known != nullptr) known = *context.known;
    if (errors_.size() == 0) throw NumericalError("it diverged");
    MatrixF predictions = MatrixF::Zero(data.values.rows(), data.values.cols());
    for (const std::size_t k : wanted) {
      for (const std::size_t row : folds[k]) {
        const auto i = static_cast<Eigen::Index>(row);
        predictions.row(i) = data.values.row(i) - errors_.row(i);
      }
    }
    return predictions;
  }

  mutable std::optional<methods::FoldPredictions> known;  ///< what predict_folds() was told last

 private:
  std::string name_;
  MatrixF errors_;
};

/// Independent normal errors of this size in every case and cell.
inline MatrixF noise(const field::FieldData& data, std::string_view name, double size) {
  base::Random random(base::Seed(41).derive(name));
  MatrixF errors(data.values.rows(), data.values.cols());
  for (Eigen::Index i = 0; i < errors.size(); ++i)
    errors.data()[i] = static_cast<float>(size * random.normal());
  return errors;
}

/// The same of size 0.1, with the given factor in the left
/// half of every plane, and its inverse in the right half.
inline MatrixF lopsided(const field::FieldData& data, std::string_view name, float left) {
  MatrixF errors = noise(data, name, 0.1);
  const auto n_columns = static_cast<Eigen::Index>(data.cases->mesh.n_columns);
  for (Eigen::Index c = 0; c < errors.cols(); ++c)
    errors.col(c) *= c % n_columns < n_columns / 2 ? left : 1 / left;
  return errors;
}

}  // namespace elrom::test
