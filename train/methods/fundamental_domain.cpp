#include "fundamental_domain.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::methods {

namespace {

/// The corner of a box at its first cell whose columns, in their order, are these; else nothing.
std::optional<Box> corner_of(const Box& whole, std::span<const std::int32_t> columns) {
  const std::size_t width = whole.sizes[2];
  std::size_t n_x = 0;
  while (n_x < columns.size() && n_x < width && std::cmp_equal(columns[n_x], n_x)) ++n_x;
  if (n_x == 0 || columns.size() % n_x != 0) return std::nullopt;
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (std::cmp_not_equal(columns[k], k / n_x * width + k % n_x)) return std::nullopt;
  Box corner{{whole.sizes[0], columns.size() / n_x, n_x}};
  for (std::size_t axis = 1; axis < 3; ++axis) {
    corner.mirrored[axis] = corner.sizes[axis] < whole.sizes[axis];
    if (corner.mirrored[axis] && 2 * corner.sizes[axis] != whole.sizes[axis]) return std::nullopt;
  }
  return corner;
}

std::size_t axis_of(const field::Mirror& mirror) { return mirror.axes == "y" ? 1 : 2; }

std::vector<std::vector<int>> signs_of(const std::vector<SymmetryClass>& classes) {
  std::vector<std::vector<int>> signs;
  for (const SymmetryClass& one : classes) signs.push_back(one.signs);
  return signs;
}

}  // namespace

FundamentalDomain::FundamentalDomain(const field::CaseSet& cases, field::Parity parity,
                                     const std::vector<SymmetryClass>& classes)
    : n_planes_(cases.mesh.n_planes),
      n_all_columns_(cases.mesh.n_columns),
      columns_(n_all_columns_),
      box_(box_of(cases.mesh)),
      fold_(cases.mirrors, parity, signs_of(classes), n_planes_, n_all_columns_) {
  keeps_planes_ = cases.mirrors.empty() || !fold_.empty();
  std::iota(columns_.begin(), columns_.end(), 0);
  take_domain(cases);

  images_.emplace_back();
  for (std::size_t plane = 0; plane < n_planes_; ++plane)
    for (const std::int32_t column : columns_)
      images_.front().push_back(static_cast<std::int32_t>(plane * n_all_columns_) + column);
  signs_.assign(classes.size(), {1});
  beyond_.resize(classes.size());
  for (std::size_t k = 0; k < cases.mirrors.size(); ++k) {
    const field::Mirror& mirror = cases.mirrors[k];
    for (std::size_t i = 0, n = images_.size(); i < n; ++i) {
      auto image = images_[i];
      for (auto& cell : image) cell = mirror.cell_from[static_cast<std::size_t>(cell)];
      images_.push_back(std::move(image));
    }
    axes_.push_back(axis_of(mirror));
    for (std::size_t c = 0; c < classes.size(); ++c) {
      const auto sign = static_cast<float>(classes[c].signs[k] * mirror.field_sign(parity));
      for (std::size_t i = 0, n = signs_[c].size(); i < n; ++i) signs_[c].push_back(sign * signs_[c][i]);
      beyond_[c].push_back(sign > 0 ? math::Beyond::same : math::Beyond::negative);
    }
  }
}

void FundamentalDomain::take_domain(const field::CaseSet& cases) {
  if (fold_.empty() || fold_.n_orbits() << cases.mirrors.size() != n_all_columns_) return;
  const auto stored = fold_.stored_columns();
  if (box_) {
    auto corner = corner_of(*box_, stored);
    if (!corner) return;
    std::array<bool, 3> mirrored{};
    for (const field::Mirror& mirror : cases.mirrors) mirrored[axis_of(mirror)] = true;
    if (corner->mirrored != mirrored) return;
    box_ = corner;
  }
  columns_.assign(stored.begin(), stored.end());
  root_ = std::sqrt(static_cast<float>(n_all_columns_ / columns_.size()));
  is_whole_ = false;
}

std::optional<Box> FundamentalDomain::box(std::size_t i_class) const {
  auto box = box_;
  if (is_whole_ || !box) return box;
  for (std::size_t k = 0; k < axes_.size(); ++k) box->beyond[axes_[k]] = beyond_[i_class][k];
  return box;
}

MatrixF FundamentalDomain::project(const MatrixF& values, std::span<const std::size_t> rows,
                                   std::size_t i_class, int n_threads) const {
  const auto n = static_cast<Eigen::Index>(n_cells());
  const double share = root_ / static_cast<double>(images_.size());
  MatrixF projected(static_cast<Eigen::Index>(rows.size()), n);
  base::parallel_for(rows.size(), n_threads, [&](std::size_t i, int) {
    const float* from = values.row(static_cast<Eigen::Index>(rows[i])).data();
    // In double the images of a class that vanishes cancel to the last bit.
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(n);
    for (std::size_t k = 0; k < images_.size(); ++k) {
      const double weight = signs_[i_class][k];
      const std::int32_t* cells = images_[k].data();
      for (Eigen::Index c = 0; c < n; ++c) sum[c] += weight * from[cells[c]];
    }
    projected.row(static_cast<Eigen::Index>(i)) = (share * sum).cast<float>();
  });
  return projected;
}

void FundamentalDomain::add(std::size_t i_class, const MatrixF& part, Eigen::Ref<MatrixF> cells,
                            int n_threads) const {
  check(part.rows() == cells.rows() && part.cols() == static_cast<Eigen::Index>(n_cells()),
        "fundamental domain: the same rows, and cells of the domain");
  if (is_whole_) {
    cells += part;
    return;
  }
  base::parallel_for(static_cast<std::size_t>(part.rows()), n_threads, [&](std::size_t i, int) {
    const auto row = static_cast<Eigen::Index>(i);
    const Eigen::RowVectorXf values = part.row(row) / root_;
    const float* from = values.data();
    float* to = cells.row(row).data();
    for (std::size_t plane = 0; plane < n_planes_; ++plane)
      fold_.add(i_class, {from + plane * n_columns(), n_columns()},
                {to + plane * n_all_columns_, n_all_columns_});
  });
}

}  // namespace elrom::methods
