#include "elrom/model/symmetry_fold.hpp"

#include <algorithm>
#include <array>

#include "elrom/base/error.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

/// How a mirror moves columns, when it does so alike in all planes; else empty.
std::vector<std::int32_t> column_map(const field::Mirror& mirror, std::size_t n_planes,
                                     std::size_t n_columns) {
  const std::vector<std::int32_t> map(mirror.cell_from.begin(),
                                      mirror.cell_from.begin() + static_cast<std::ptrdiff_t>(n_columns));
  for (std::size_t c = 0; c < n_planes * n_columns; ++c) {
    const auto base = static_cast<std::int32_t>(c / n_columns * n_columns);
    if (mirror.cell_from[c] != base + map[c % n_columns]) return {};
  }
  return map;
}

/// Signs of one class: values spread from each orbit's first column by f[j] = step * f[map[j]].
std::vector<float> class_signs_of(const std::vector<std::vector<std::int32_t>>& maps,
                                  const std::vector<float>& steps, const std::vector<std::int32_t>& first,
                                  std::size_t n_columns) {
  constexpr float unknown = 2;
  std::vector<float> sign(n_columns, unknown);
  for (const std::int32_t start : first) {
    std::vector<std::int32_t> reached{start};
    bool vanishes = false;
    sign[static_cast<std::size_t>(start)] = 1;
    for (std::size_t next = 0; next < reached.size(); ++next) {
      const auto j = static_cast<std::size_t>(reached[next]);
      for (std::size_t k = 0; k < maps.size(); ++k) {
        const auto image = static_cast<std::size_t>(maps[k][j]);
        const float value = steps[k] * sign[j];
        if (sign[image] == unknown) {
          sign[image] = value;
          reached.push_back(maps[k][j]);
        } else if (sign[image] != value) {
          vanishes = true;  // a column that is its own image with the opposite sign
        }
      }
    }
    if (vanishes) {
      for (const std::int32_t j : reached) sign[static_cast<std::size_t>(j)] = 0;
    }
  }
  return sign;
}

}  // namespace

SymmetryFold::SymmetryFold(const std::vector<field::Mirror>& mirrors, field::Parity parity,
                           const std::vector<std::vector<int>>& class_signs, std::size_t n_planes,
                           std::size_t n_columns) {
  std::vector<std::vector<std::int32_t>> maps;
  for (const auto& mirror : mirrors) {
    maps.push_back(column_map(mirror, n_planes, n_columns));
    if (maps.back().empty()) return;
  }
  if (maps.empty()) return;

  // An orbit is known by its least column.
  std::vector<std::int32_t> least(n_columns);
  for (std::size_t j = 0; j < n_columns; ++j) least[j] = static_cast<std::int32_t>(j);
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& map : maps) {
      for (std::size_t j = 0; j < n_columns; ++j) {
        const auto lower = std::min(least[j], least[static_cast<std::size_t>(map[j])]);
        changed = changed || lower != least[j];
        least[j] = lower;
      }
    }
  }
  std::vector<std::int32_t> number(n_columns, -1);
  for (std::size_t j = 0; j < n_columns; ++j) {
    if (least[j] != static_cast<std::int32_t>(j)) continue;
    number[j] = static_cast<std::int32_t>(first_.size());
    first_.push_back(static_cast<std::int32_t>(j));
  }
  n_orbits_ = first_.size();
  orbit_.resize(n_columns);
  for (std::size_t j = 0; j < n_columns; ++j) orbit_[j] = number[static_cast<std::size_t>(least[j])];

  std::vector<float> signs;
  for (const auto& of_class : class_signs) {
    check(of_class.size() == mirrors.size(), "a sign for every mirror");
    std::vector<float> steps;
    for (std::size_t k = 0; k < mirrors.size(); ++k) {
      steps.push_back(static_cast<float>(of_class[k] * mirrors[k].field_sign(parity)));
    }
    const auto one = class_signs_of(maps, steps, first_, n_columns);
    signs.insert(signs.end(), one.begin(), one.end());
  }
  sign_ = io::Tensor::copy(std::span<const float>(signs), {class_signs.size(), n_columns});
}

std::vector<std::vector<std::size_t>> SymmetryFold::orbits() const {
  std::vector<std::vector<std::size_t>> orbits(n_orbits_);
  for (std::size_t j = 0; j < orbit_.size(); ++j) orbits[static_cast<std::size_t>(orbit_[j])].push_back(j);
  return orbits;
}

void SymmetryFold::pick(std::span<const float> column, std::span<float> stored) const {
  for (std::size_t o = 0; o < n_orbits_; ++o) stored[o] = column[static_cast<std::size_t>(first_[o])];
}

void SymmetryFold::add(std::size_t i_class, std::span<const float> stored, std::span<float> column) const {
  const float* sign = sign_.f32().data() + i_class * orbit_.size();
  for (std::size_t j = 0; j < orbit_.size(); ++j)
    column[j] += sign[j] * stored[static_cast<std::size_t>(orbit_[j])];
}

void SymmetryFold::add_squares(std::size_t i_class, std::span<const float> stored,
                               std::span<float> column) const {
  const float* sign = sign_.f32().data() + i_class * orbit_.size();
  for (std::size_t j = 0; j < orbit_.size(); ++j) {
    column[j] += sign[j] * sign[j] * stored[static_cast<std::size_t>(orbit_[j])];
  }
}

void SymmetryFold::save(io::TensorFile& file, const std::string& prefix) const {
  if (empty()) return;
  file.set(prefix + "/orbit", io::Tensor::copy(std::span<const std::int32_t>(orbit_), {orbit_.size()}));
  file.set(prefix + "/sign", sign_);
}

SymmetryFold SymmetryFold::load(const io::TensorFile& file, const std::string& prefix) {
  SymmetryFold fold;
  if (!file.has(prefix + "/orbit")) return fold;
  const std::array<std::size_t, 1> any{io::any_size};
  const auto orbit = file.tensor(prefix + "/orbit", any).i32();
  fold.orbit_.assign(orbit.begin(), orbit.end());
  const std::array<std::size_t, 2> table{io::any_size, orbit.size()};
  fold.sign_ = file.tensor(prefix + "/sign", table);

  // Orbits are numbered in the order of their first columns.
  for (std::size_t j = 0; j < orbit.size(); ++j) {
    const auto next = static_cast<std::int32_t>(fold.first_.size());
    if (orbit[j] == next) fold.first_.push_back(static_cast<std::int32_t>(j));
    if (orbit[j] < 0 || orbit[j] > next) {
      throw InputError({.what = "broken symmetry fold",
                        .where = file.where() + ":" + prefix + "/orbit",
                        .found = "orbit " + std::to_string(orbit[j]) + " of column " + std::to_string(j),
                        .expected = "orbits numbered by their first columns"});
    }
  }
  fold.n_orbits_ = fold.first_.size();
  const auto signs = fold.sign_.f32();
  if (!std::ranges::all_of(signs, [](float s) { return s == -1 || s == 0 || s == 1; })) {
    throw InputError({.what = "broken symmetry fold",
                      .where = file.where() + ":" + prefix + "/sign",
                      .expected = "signs -1, 0 or 1"});
  }
  return fold;
}

}  // namespace elrom::model
