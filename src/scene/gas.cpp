#include "elrom/scene/gas.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/model/prediction_file.hpp"

namespace elrom::scene {
namespace {

class UniformGas final : public GasField {
 public:
  explicit UniformGas(const Vec& velocity) : velocity_(velocity) {}
  void velocity(const Vectors&, std::size_t, std::span<Vec> velocities) const override {
    std::ranges::fill(velocities, velocity_);
  }

 private:
  Vec velocity_;
};

using Index = std::array<std::size_t, 3>;

// Points of a regular grid over the centres' box.
struct Grid {
  std::array<double, 3> low{}, step{};
  Index count{1, 1, 1};

  // Cubes whose number is about that of the centres.
  explicit Grid(const MatrixD& centres) {
    std::array<double, 3> size{};
    double volume = 1;
    int n_wide = 0;
    for (Eigen::Index a = 0; a < 3; ++a) {
      const auto at = static_cast<std::size_t>(a);
      low[at] = centres.col(a).minCoeff();
      size[at] = centres.col(a).maxCoeff() - low[at];
      if (size[at] > 0) volume *= size[at], ++n_wide;
    }
    const double edge = n_wide > 0 ? std::pow(volume / static_cast<double>(centres.rows()), 1.0 / n_wide) : 1;
    for (std::size_t a = 0; a < 3; ++a) {
      count[a] = 1 + static_cast<std::size_t>(std::min(1e4, std::ceil(size[a] / edge)));
      step[a] = count[a] > 1 ? size[a] / static_cast<double>(count[a] - 1) : 1;
    }
  }
  [[nodiscard]] std::size_t size() const { return count[0] * count[1] * count[2]; }
  [[nodiscard]] std::size_t at(const Index& i) const { return i[0] + count[0] * (i[1] + count[1] * i[2]); }
  [[nodiscard]] Index nearest(const Vec& place) const {
    const auto x = array_of(place);
    Index index{};
    for (std::size_t a = 0; a < 3; ++a)
      index[a] = static_cast<std::size_t>(
          std::clamp(std::nearbyint((x[a] - low[a]) / step[a]), 0.0, static_cast<double>(count[a] - 1)));
    return index;
  }
  [[nodiscard]] Vec point(const Index& i) const {
    return {low[0] + step[0] * static_cast<double>(i[0]), low[1] + step[1] * static_cast<double>(i[1]),
            low[2] + step[2] * static_cast<double>(i[2])};
  }
};

class FrozenGas final : public GasField {
 public:
  FrozenGas(const MatrixD& centres, const MatrixD& velocities, int n_threads)
      : grid_(centres), values_(grid_.size()) {
    const Buckets buckets(grid_, centres);
    base::parallel_for(grid_.count[2], n_threads, [&](std::size_t z, int) {
      for (std::size_t y = 0; y < grid_.count[1]; ++y)
        for (std::size_t x = 0; x < grid_.count[0]; ++x)
          values_[grid_.at({x, y, z})] = buckets.fitted(grid_, {x, y, z}, centres, velocities);
    });
  }

  void velocity(const Vectors& place, std::size_t first, std::span<Vec> velocities) const override {
    for (std::size_t k = 0; k < velocities.size(); ++k) velocities[k] = at(get(place, first + k));
  }
  [[nodiscard]] std::size_t bytes() const override { return values_.capacity() * sizeof(Vec); }

 private:
  // Centres by their nearest grid point.
  struct Buckets {
    std::vector<std::vector<std::int32_t>> members;

    Buckets(const Grid& grid, const MatrixD& centres) : members(grid.size()) {
      for (Eigen::Index c = 0; c < centres.rows(); ++c)
        members[grid.at(grid.nearest({centres(c, 0), centres(c, 1), centres(c, 2)}))].push_back(
            static_cast<std::int32_t>(c));
    }
    // The plane (linear in x, y, z) through the centres around a point that fits best, weighted by the
    // inverse square of their distance, at the point; within the values found. The search widens until it
    // finds some.
    [[nodiscard]] Vec fitted(const Grid& grid, const Index& at, const MatrixD& centres,
                             const MatrixD& velocities) const {
      const Eigen::Array3d step(grid.step[0], grid.step[1], grid.step[2]);
      const Vec p = grid.point(at);
      for (std::size_t reach = 1;; reach *= 2) {
        Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
        Eigen::Matrix<double, 4, 3> right = Eigen::Matrix<double, 4, 3>::Zero();
        Eigen::RowVector3d least = Eigen::RowVector3d::Constant(HUGE_VAL), most = -least;
        for_each_near(grid, at, reach, [&](Eigen::Index c) {
          const Eigen::Vector3d d =
              ((centres.row(c).transpose().array() - Eigen::Array3d(p.x, p.y, p.z)) / step).matrix();
          const Eigen::Vector4d terms(1, d[0], d[1], d[2]);
          const double weight = 1 / (d.squaredNorm() + 1e-6);
          normal += weight * terms * terms.transpose();
          right += weight * terms * velocities.row(c);
          least = least.cwiseMin(velocities.row(c));
          most = most.cwiseMax(velocities.row(c));
        });
        if (normal(0, 0) == 0) continue;
        // Centres in a plane or on a line tell no slope across it.
        normal.diagonal().tail<3>().array() += 1e-9 * normal(0, 0);
        const Eigen::RowVector3d value = normal.ldlt().solve(right).row(0).cwiseMax(least).cwiseMin(most);
        return {value[0], value[1], value[2]};
      }
    }
    template <class Work>
    void for_each_near(const Grid& grid, const Index& at, std::size_t reach, const Work& work) const {
      Index from, to;
      for (std::size_t a = 0; a < 3; ++a) {
        from[a] = at[a] > reach ? at[a] - reach : 0;
        to[a] = std::min(grid.count[a] - 1, at[a] + reach);
      }
      for (std::size_t z = from[2]; z <= to[2]; ++z)
        for (std::size_t y = from[1]; y <= to[1]; ++y)
          for (std::size_t x = from[0]; x <= to[0]; ++x)
            for (const auto c : members[grid.at({x, y, z})]) work(c);
    }
  };

  [[nodiscard]] Vec at(const Vec& place) const {
    const auto x = array_of(place);
    Index below{}, above{};
    std::array<double, 3> share{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double along =
          std::clamp((x[a] - grid_.low[a]) / grid_.step[a], 0.0, static_cast<double>(grid_.count[a] - 1));
      below[a] = static_cast<std::size_t>(along);
      above[a] = std::min(below[a] + 1, grid_.count[a] - 1);
      share[a] = along - static_cast<double>(below[a]);
    }
    const auto along_x = [&](std::size_t y, std::size_t z) {
      return (1 - share[0]) * values_[grid_.at({below[0], y, z})] +
             share[0] * values_[grid_.at({above[0], y, z})];
    };
    const auto along_y = [&](std::size_t z) {
      return (1 - share[1]) * along_x(below[1], z) + share[1] * along_x(above[1], z);
    };
    return (1 - share[2]) * along_y(below[2]) + share[2] * along_y(above[2]);
  }

  Grid grid_;
  std::vector<Vec> values_;
};

}  // namespace

std::unique_ptr<GasField> uniform_gas(const Vec& velocity) { return std::make_unique<UniformGas>(velocity); }

std::unique_ptr<GasField> frozen_gas(const MatrixD& centres, const MatrixD& velocities, int n_threads) {
  if (centres.rows() == 0 || centres.cols() != 3 || velocities.rows() != centres.rows() ||
      velocities.cols() != 3)
    throw InputError(
        Problem{.what = "a gas field without cells", .expected = "three components in each cell"});
  if (!centres.allFinite() || !velocities.allFinite())
    throw InputError(Problem{.what = "a gas field with values that are no numbers"});
  return std::make_unique<FrozenGas>(centres, velocities, n_threads);
}

std::unique_ptr<GasField> frozen_gas(const std::filesystem::path& path, int n_threads) {
  const auto prediction = model::read_prediction(path);
  if (prediction.profiles)
    throw InputError(Problem{.what = "a prediction of plane averages is no gas field",
                             .where = path.string(),
                             .expected = "one of cells"});
  const auto n = static_cast<Eigen::Index>(prediction.centre.size() / 3);
  const MatrixD centres = Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
                              prediction.centre.data(), n, 3)
                              .cast<double>();
  MatrixD velocities(n, 3);
  for (const auto& [column, name] :
       {std::pair{0, "gas_velocity_x"}, {1, "gas_velocity_y"}, {2, "gas_velocity_z"}}) {
    const auto& field = prediction.field(name);
    velocities.col(column) = Eigen::Map<const Eigen::VectorXf>(field.values.data(), n).cast<double>();
  }
  return frozen_gas(centres, velocities, n_threads);
}

}  // namespace elrom::scene
