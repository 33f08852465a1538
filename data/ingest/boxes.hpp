#pragma once
// A coarse grid of boxes over a case's cells: what sketches are made of.

#include <algorithm>
#include <array>

#include "elrom/ingest/case_summary.hpp"

namespace elrom::ingest {

/// Where cells lie, relative to the box around all centres, and what they weigh.
class Boxes {
 public:
  static constexpr std::array<int, 3> size{4, 6, 12};  // in x, y, z
  static constexpr int n_boxes = size[0] * size[1] * size[2];

  explicit Boxes(const CheckedCase& view) : view_(view) {
    low_ = view.centre->colwise().minCoeff();
    high_ = view.centre->colwise().maxCoeff();
  }
  [[nodiscard]] double weight(Eigen::Index i) const {
    return view_.volume.empty() ? 1.0 : view_.volume[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double relative(Eigen::Index i, int d) const {
    const double extent = high_(d) - low_(d);
    return extent > 0 ? ((*view_.centre)(i, d) - low_(d)) / extent : 0.5;
  }
  [[nodiscard]] int box(Eigen::Index i) const {
    int index = 0;
    for (int d = 2; d >= 0; --d) {
      const int n = size[static_cast<std::size_t>(d)];
      index = index * n + std::clamp(static_cast<int>(relative(i, d) * n), 0, n - 1);
    }
    return index;
  }
  [[nodiscard]] double extent(int d) const { return high_(d) - low_(d); }

 private:
  const CheckedCase& view_;
  Eigen::RowVector3d low_, high_;
};

}  // namespace elrom::ingest
