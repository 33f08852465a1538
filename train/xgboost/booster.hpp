#pragma once
// XGBoost's C interface, owned: tables in, trees grown round by round, predictions, flat trees out. Internal to
// train/xgboost. Every failure of XGBoost becomes an Error with its words.

#include <Eigen/Core>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "elrom/particle/trees.hpp"

namespace elrom::xgboost {

/// Records as XGBoost keeps them.
class Matrix {
 public:
  /// @param inputs finite numbers, also as floats
  explicit Matrix(const particle::Table& inputs);
  ~Matrix();
  Matrix(const Matrix&) = delete;
  Matrix& operator=(const Matrix&) = delete;

  /// @param field "label" or "weight"
  void set(const char* field, const Eigen::ArrayXd& values);
  [[nodiscard]] void* handle() const { return handle_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }

 private:
  void* handle_ = nullptr;
  std::size_t rows_;
};

/// Thread rule: one thread.
class Booster {
 public:
  /// @param watched predicted after each round without walking old trees again
  Booster(const Matrix& train, const Matrix& watched, const std::map<std::string, std::string>& parameters);
  ~Booster();
  Booster(const Booster&) = delete;
  Booster& operator=(const Booster&) = delete;

  void grow(int round);
  /// Valid until the next call.
  [[nodiscard]] std::span<const float> predict(const Matrix& matrix) const;
  /// The first `n_rounds` trees, behind each other; `base` is the base score.
  struct Flat {
    std::vector<particle::TreeNode> nodes;
    particle::TreeGroup group;
  };
  [[nodiscard]] Flat trees(int n_rounds) const;

 private:
  const Matrix& train_;
  void* handle_ = nullptr;
};

}  // namespace elrom::xgboost
