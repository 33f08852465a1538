#include "generator_fields.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "elrom/base/error.hpp"

namespace elrom::ingest {

namespace {

constexpr double standard_gravity = 9.81;  // m/s2
constexpr double solids_density = 2400.0;  // kg/m3
constexpr double furnace_height = field::TaperedFurnace{}.height_m;
constexpr double densest = 0.6;

// Closeness to the walls: 0 in the core, 1 at a wall.
double wall_of(double x, double y) { return std::pow(std::max(std::abs(x), std::abs(y)), 6); }

// How much denser than its plane a place is, before scaling to a mean of one.
double annulus(double wall) { return 0.8 + 1.6 * wall; }

double smooth_step(double x) { return 1 / (1 + std::exp(-x)); }

std::vector<double> evenly(std::size_t n, double low, double high) {
  std::vector<double> places;
  for (std::size_t i = 0; i < n; ++i)
    places.push_back(low + (high - low) * (static_cast<double>(i) + 0.5) / static_cast<double>(n));
  return places;
}

std::vector<double> closeness(const std::vector<double>& places, double centre, double width) {
  std::vector<double> near;
  for (const double place : places)
    near.push_back(std::exp(-0.5 * (place - centre) * (place - centre) / (width * width)));
  return near;
}

}  // namespace

struct FieldGenerator::State {
  std::vector<double> inlet;  //!< mass flow of each input, 0 where it is no inlet [kg/s], (n_inputs)
  double load = 1, inventory = 1e5, d50 = 320e-6, spread = 0.4, temperature = 1100, left_share = 0.5;
  double gas_density = 0.32, terminal = 2;
  std::vector<double> rise, fraction,
      pressure;  //!< plane means: gas velocity, volume fraction, pressure, (n_planes)
};

FieldGenerator::FieldGenerator(const field::Mesh& mesh, std::size_t n_x, std::vector<GeneratorInput> inputs,
                               std::vector<field::FieldInfo> fields, double noise)
    : mesh_(mesh),
      n_x_(n_x),
      n_y_(mesh.n_columns / n_x),
      inputs_(std::move(inputs)),
      fields_(std::move(fields)),
      noise_(noise),
      across_x_(evenly(n_x_, -1, 1)),
      across_y_(evenly(n_y_, -1, 1)),
      height_(evenly(mesh.n_planes, 0, 1)) {
  check(n_x_ * n_y_ == mesh.n_columns, "columns are no lattice");
  const double plane_height = furnace_height / static_cast<double>(mesh.n_planes);
  for (std::size_t k = 0; k < mesh.n_planes; ++k) {
    const auto begin = mesh.volume.begin() + static_cast<std::ptrdiff_t>(k * mesh.n_columns);
    area_.push_back(std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(mesh.n_columns), 0.0) /
                    plane_height);
  }
  for (const double x : across_x_) {
    for (const double y : across_y_)
      mean_annulus_ += annulus(wall_of(x, y)) / static_cast<double>(mesh.n_columns);
  }
  for (const auto& input : inputs_) {
    near_x_.push_back(closeness(across_x_, input.x, 0.6));
    near_y_.push_back(closeness(across_y_, input.y, 0.15));
    near_z_.push_back(closeness(height_, input.height, 0.04));
  }
}

FieldGenerator::State FieldGenerator::state_of(const DesignPoint& point) const {
  State state;
  state.load = point.load;
  state.inlet.assign(inputs_.size(), 0);
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const double value = point.values[i];
    switch (inputs_[i].role) {
      case Role::gas_inlet:
        state.inlet[i] = value;
        break;
      case Role::inventory:
        state.inventory = value;
        break;
      case Role::diameter:
        state.d50 = value;
        break;
      case Role::spread:
        state.spread = value;
        break;
      case Role::temperature:
        state.temperature = value;
        break;
      case Role::left_share:
        state.left_share = value;
        break;
    }
  }
  constexpr double air = 101325.0 / 287.0;  // pressure / gas constant [kg K/m3]
  state.gas_density = air / state.temperature;
  constexpr double typical_d50 = 320e-6, typical_terminal = 2.2;  // m, m/s
  state.terminal =
      typical_terminal * std::pow(state.d50 / typical_d50, 1.3) * std::sqrt(state.temperature / 1100.0);
  fill_profiles(state);
  return state;
}

// Plane means over the height: gas rise, volume fraction
// scaled to the inventory, and the pressure that follows.
void FieldGenerator::fill_profiles(State& state) const {
  const auto n = height_.size();
  const double dz = furnace_height / static_cast<double>(n);
  state.rise.resize(n);
  state.fraction.resize(n);
  state.pressure.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    double entered = 0;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      entered += state.inlet[i] *
                 (inputs_[i].height == 0 ? 1.0 : smooth_step((height_[k] - inputs_[i].height) / 0.01));
    }
    state.rise[k] = entered / (state.gas_density * area_[k]);
  }
  const double lift = state.rise.back() / state.terminal;
  const double bed = 0.02 + 0.04 / (0.5 + lift), decay = 9.0 / (0.5 + lift), dilute = 0.003 * lift;
  double weight = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double above = std::max(0.0, height_[k] - bed);
    state.fraction[k] = 0.3 * smooth_step((bed - height_[k]) / 0.008) + 0.02 * std::exp(-decay * above) +
                        dilute * std::exp(-above);
    weight += state.fraction[k] * solids_density * area_[k] * dz;
  }
  double above = 0;
  for (std::size_t k = n; k-- > 0;) {
    state.fraction[k] = std::min(densest, state.fraction[k] * state.inventory / weight);
    above += (state.fraction[k] * solids_density + state.gas_density) * standard_gravity * dz;
    state.pressure[k] = above;
  }
}

// The nine standard fields in their order.
std::array<double, 9> FieldGenerator::cell(const State& state, std::size_t k, std::size_t i,
                                           std::size_t j) const {
  const double x = across_x_[i], y = across_y_[j];
  const double wall = wall_of(x, y);
  double jet_x = 0, jet_y = 0, jet = 0;
  for (std::size_t n = 0; n < inputs_.size(); ++n) {
    if (state.inlet[n] == 0 || inputs_[n].height == 0) continue;
    const double strength = state.inlet[n] * near_x_[n][i] * near_y_[n][j] * near_z_[n][k];
    jet_x -= inputs_[n].x * strength;
    jet_y -= inputs_[n].y * strength;
    jet += strength;
  }
  constexpr double speed_per_flow = 0.4;                  // m/s for each kg/s
  const double tilt = 1 + (state.left_share - 0.5) * -y;  // more solids return on the left
  const double gas_z = state.rise[k] * 1.25 * (1 - 0.9 * wall) + 0.1 * jet;
  const double fall = (2.0 + 1.5 * state.load) * wall;
  const double solid_z = gas_z - state.terminal * (1 - wall) - fall;
  const double gas_x = speed_per_flow * jet_x, gas_y = speed_per_flow * jet_y;
  const double drift = 0.3 * state.load * (1 - wall);
  const double fraction = std::min(densest, state.fraction[k] * tilt * annulus(wall) / mean_annulus_);
  const double coarse = 1 + 0.3 * state.spread * (0.5 - height_[k]) * 2 + 0.05 * wall;
  const double pressure =
      state.pressure[k] + 2.0 * jet * state.gas_density - 0.5 * state.gas_density * gas_z * gas_z;
  return {0.7 * gas_x + drift * x,
          0.7 * gas_y + drift * y,
          solid_z,
          gas_x,
          gas_y,
          gas_z,
          pressure,
          state.d50 * coarse,
          fraction};
}

double FieldGenerator::tracer(const State& state, std::size_t number, std::size_t k, std::size_t i,
                              std::size_t j) const {
  if (inputs_.empty()) return 0.5;
  const auto n = number % inputs_.size();
  const double total = std::max(1e-12, std::accumulate(state.inlet.begin(), state.inlet.end(), 0.0));
  const double mixed = smooth_step((height_[k] - inputs_[n].height) / 0.2);
  const double share = 0.02 + state.inlet[n] / total;
  return share * mixed + (1 - mixed) * near_x_[n][i] * near_y_[n][j] * near_z_[n][k];
}

// Smooth waves (averages that have not settled) and white noise, both scaled to the field's own deviation.
void FieldGenerator::add_noise(std::span<float> values, const field::FieldInfo& field,
                               base::Random random) const {
  double sum = 0, squares = 0;
  for (const float v : values) {
    sum += static_cast<double>(v);
    squares += static_cast<double>(v) * static_cast<double>(v);
  }
  const auto n = static_cast<double>(values.size());
  const double deviation = std::sqrt(std::max(0.0, squares / n - sum / n * (sum / n)));
  constexpr int n_waves = 6;
  std::vector<double> waves(values.size(), 0.0);
  for (int wave = 0; wave < n_waves; ++wave) {
    const auto draw = [&](const std::vector<double>& places, double most) {
      const double rate = random.uniform(-most, most) * std::numbers::pi,
                   phase = random.uniform(0, 2 * std::numbers::pi);
      std::vector<double> line;
      for (const double place : places) line.push_back(std::cos(rate * place + phase));
      return line;
    };
    const auto along_x = draw(across_x_, 2), along_y = draw(across_y_, 4), along_z = draw(height_, 10);
    for (std::size_t c = 0; c < values.size(); ++c) {
      waves[c] += along_x[c % n_x_] * along_y[c / n_x_ % n_y_] * along_z[c / mesh_.n_columns];
    }
  }
  const bool positive = field.lower.has_value();
  for (std::size_t c = 0; c < values.size(); ++c) {
    const double disturbance = noise_ * (waves[c] + 0.5 * random.normal());
    const double value = static_cast<double>(values[c]);
    // A bounded field is disturbed in proportion, so that it stays on its side of zero.
    double noisy = positive ? value * std::exp(disturbance) : value + deviation * disturbance;
    if (field.upper) noisy = std::min(noisy, *field.upper);
    values[c] = static_cast<float>(noisy);
  }
}

MatrixF FieldGenerator::fields(const DesignPoint& point, base::Seed seed) const {
  const auto state = state_of(point);
  const auto n_standard = field::standard_fields().size();
  MatrixF values(static_cast<Eigen::Index>(fields_.size()), static_cast<Eigen::Index>(mesh_.n_cells()));
  for (std::size_t c = 0; c < mesh_.n_cells(); ++c) {
    const auto i = c % n_x_, j = c / n_x_ % n_y_, k = c / mesh_.n_columns;
    const auto standard = cell(state, k, i, j);
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const double value = f < n_standard ? standard[f] : tracer(state, f - n_standard, k, i, j);
      values(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(c)) = static_cast<float>(value);
    }
  }
  for (std::size_t f = 0; f < fields_.size(); ++f) {
    add_noise({values.row(static_cast<Eigen::Index>(f)).data(), mesh_.n_cells()}, fields_[f],
              base::Random(seed.derive(f)));
  }
  return values;
}

}  // namespace elrom::ingest
