#include "scene_beds.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <numeric>

#include "elrom/scene/simulation.hpp"

namespace elrom::benchmark {
namespace {

using Json = nlohmann::ordered_json;
using namespace elrom::scene;

// Means over time of what holds a bed up. Pressures in Pa, forces upwards in N. Through a layer of faces of
// area A the gas loses A dp = lift + dM and the solids take lift = weight + dM - walls, each M the flux of
// vertical momentum that it carries by moving, up or down. Forces are spread over faces as the gas does it:
// the area that counts is the one that gas goes through. A bed that is thrown up where it is narrow and falls
// back where it is wide loses more than its weight.
class Balance {
 public:
  Balance(const Simulation& simulation, double from)
      : simulation_(simulation), from_(from), mass_(mass_of(simulation.state().particles)) {
    const auto& grid = simulation.flow()->grid();
    in_layer_ = grid.count()[0] * grid.count()[1];
    for (auto* values : {&area_, &layer_pressure_, &layer_head_, &layer_mass_, &layer_momentum_, &layer_flux_,
                         &layer_gas_flux_})
      values->assign(grid.count()[2], 0);
    for (std::size_t c = 0; c < grid.size(); ++c)
      if (grid.is_open(c)) area_[c / in_layer_] += grid.space(c) / grid.step()[2];
    face_area_.assign(grid.face_count(2), 0);
    std::vector<double> of_layer(grid.count()[2] + 1, 0);
    const double face = grid.step()[0] * grid.step()[1];
    for (std::size_t f = 0; f < face_area_.size(); ++f)
      if (grid.is_face_open(2, f)) of_layer[f / in_layer_] += face;
    for (std::size_t f = 0; f < face_area_.size(); ++f)
      if (grid.is_face_open(2, f)) face_area_[f] = of_layer[f / in_layer_];
  }

  // Before a step: forces act there.
  void look_ahead() { ahead_ = simulation_.state().particles; }
  // After a step.
  void look() {
    const auto& s = simulation_.state();
    const double momentum = momentum_of(s.particles).z;
    if (s.time > from_) {
      ++n_;
      pressure_ += simulation_.flow()->inlet_pressure();
      weigh(s);
      walls_ += (momentum - before_) / simulation_.settings().time_step;
    }
    before_ = momentum;
  }

  [[nodiscard]] Json json() const {
    const auto mean = [&](double sum) { return sum / static_cast<double>(n_); };
    double waiting = 0;
    for (const auto& w : simulation_.state().waiting)
      waiting += w.weight * particle::sphere_mass(w.diameter, w.density);
    const double mass = mass_of(simulation_.state().particles) + waiting;
    return {{"pressure_drop_pa", mean(pressure_)},
            {"weight_per_area_pa", mean(head_)},
            {"dp_error", pressure_ / head_ - 1},
            {"gas_carries_pa", mean(carried_)},
            {"gas_acceleration_pa", mean(acceleration(layer_gas_flux_, inflow_))},
            {"solids_acceleration_pa", mean(acceleration(layer_flux_, 0))},
            {"gas_lifts_of_weight", lift_ / weight_},
            {"walls_lift_of_weight", (walls_ - lift_ + weight_) / weight_},
            {"mass_error", mass / mass_ - 1},
            {"left", simulation_.state().tally.left},
            {"planes", planes()}};
  }
  // Each layer of cells: pressure at its middle, and the weight of what lies above over the areas there.
  [[nodiscard]] Json planes() const {
    const auto& grid = simulation_.flow()->grid();
    Json rows = Json::array();
    double above = 0;
    for (std::size_t k = area_.size(); k-- > 0;) {
      const double own = layer_head_[k] / static_cast<double>(n_);
      rows.push_back({{"z_m", grid.centre(k * in_layer_).z},
                      {"pressure_pa", layer_pressure_[k] / static_cast<double>(n_)},
                      {"weight_above_pa", above + 0.5 * own},
                      {"flux_pa", layer_flux_[k] / static_cast<double>(n_)},
                      {"gas_flux_pa", layer_gas_flux_[k] / static_cast<double>(n_)},
                      {"solids_m_per_s", layer_mass_[k] > 0 ? layer_momentum_[k] / layer_mass_[k] : 0}});
      above += own;
    }
    return rows;
  }

 private:
  void weigh(const State& s) {
    const auto& p = s.particles;
    const auto& grid = simulation_.flow()->grid();
    for (std::size_t c = 0; c < grid.size(); ++c)
      if (grid.is_open(c))
        layer_pressure_[c / in_layer_] +=
            simulation_.flow()->pressure()[c] * grid.space(c) / (area_[c / in_layer_] * grid.step()[2]);
    std::vector<double> solids(grid.size(), 0);  // m3
    const double g = -simulation_.settings().gravity.z, gas = simulation_.settings().gas_properties.density;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const double weight = p.mass[i] * g * (1 - gas / p.density[i]);
      const auto cell = grid.cell_at(get(p.place, i)), layer = cell / in_layer_;
      solids[cell] += p.mass[i] / p.density[i];
      layer_head_[layer] += weight / area_[layer];
      layer_mass_[layer] += p.mass[i], layer_momentum_[layer] += p.mass[i] * p.velocity[2][i];
      layer_flux_[layer] += p.mass[i] * p.velocity[2][i] * p.velocity[2][i] / (area_[layer] * grid.step()[2]);
      head_ += weight / area_[layer];
    }
    for (std::size_t i = 0; i < ahead_.size(); ++i) {
      const double weight = ahead_.mass[i] * g * (1 - gas / ahead_.density[i]),
                   lift = ahead_.mass[i] * s.push[2][i] + weight;
      weight_ += weight, lift_ += lift;
      const auto shares = grid.faces(get(ahead_.place, i), 2);
      for (std::size_t k = 0; k < 8; ++k) {
        const double area = face_area_[static_cast<std::size_t>(shares.of[k])];
        if (area > 0) carried_ += shares.weight[k] * lift / area;
      }
    }
    const double inflow = simulation_.flow()->flow_in();
    inflow_ += gas * inflow * inflow / area_.front();
    const auto& w = simulation_.flow()->velocity()[2];
    for (std::size_t c = 0; c < grid.size(); ++c) {
      if (!grid.is_open(c)) continue;
      const double speed = 0.5 * (w[grid.face(c, 2, -1)] + w[grid.face(c, 2, 1)]);
      layer_gas_flux_[c / in_layer_] +=
          gas * (grid.space(c) - solids[c]) * speed * speed / (area_[c / in_layer_] * grid.step()[2]);
    }
  }

  // Sum over time of what a flux changes by from layer to layer, each over its area.
  // @param flux of each layer, over its area @param from what comes in below, N
  [[nodiscard]] double acceleration(const std::vector<double>& flux, double from) const {
    double sum = 0, below = from;
    for (std::size_t k = 0; k < area_.size(); ++k) {
      const double own = flux[k] * area_[k];
      const double above = k + 1 < area_.size() ? 0.5 * (own + flux[k + 1] * area_[k + 1]) : own;
      sum += (above - below) / area_[k];
      below = above;
    }
    return sum;
  }

  const Simulation& simulation_;
  double from_, mass_, before_ = 0;
  std::size_t in_layer_ = 1;              // cells
  std::vector<double> area_, face_area_;  // of each layer of cells; of each face's layer, 0: a wall; m2
  Particles ahead_;
  std::vector<double> layer_pressure_, layer_head_, layer_mass_, layer_momentum_, layer_flux_,
      layer_gas_flux_;  // sums over time
  std::int64_t n_ = 0;
  double pressure_ = 0, head_ = 0, carried_ = 0, weight_ = 0, lift_ = 0, walls_ = 0, inflow_ = 0;
};

Json run_bed(const SceneSettings& settings, double from) {
  Simulation simulation(settings, 1);
  Balance balance(simulation, from);
  const auto begin = std::clock();
  while (!simulation.done()) {
    balance.look_ahead();
    simulation.step();
    balance.look();
  }
  auto json = balance.json();
  json["seconds"] = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return json;
}

}  // namespace

Json straight_beds(bool small, const std::string& collisions, const std::vector<std::string>& changes) {
  Json rows = Json::array();
  // dem takes minutes a speed.
  const bool is_dem = collisions == "dem";
  for (const double filled : is_dem || small ? std::vector{0.02} : std::vector{0.02, 0.08})
    for (const double speed : is_dem ? std::vector{0.2} : std::vector{0.12, 0.2, 0.5}) {
      const auto text = fmt::format(
          "[scene]\nduration = {}\ntime_step = 1e-3\n[domain]\noutlets = [\"box.z_high\"]\n"
          "[gas]\nmodel = \"coupled\"\n[grid]\ncell = [0.0025, 0.0025, 0.0025]\n"
          "[effects]\ngravity = [0, 0, -9.81]\nbuoyancy = true\ndrag = \"gidaspow\"\nrecirculation = \"box\"\n"
          "collisions = \"{}\"\n[walls]\nnormal_restitution = 0.8\ntangential_restitution = 0.8\n"
          "[collisions]\nrestitution = 0.9\nstiffness = 200\n"
          "[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.01, 0.01, {}]\n"
          "[[regions]]\nname = \"bottom\"\nlow = [0, 0, 0]\nhigh = [0.01, 0.01, {}]\n"
          "[[gas.inlets]]\nside = \"box.z_low\"\nvelocity = [0, 0, {}]\n"
          "[[particles]]\ngroup = \"a\"\ndiameter = \"475 um\"\nregion = \"bottom\"\n"
          "arrangement = \"lattice\"\nparcels = {}\nnumber = {}\n",
          small    ? 0.1
          : is_dem ? 0.5
                   : 1,
          collisions, 2 * filled, filled, speed, is_dem ? 1 : 4, std::lround(4e5 * filled));
      const auto settings = parse_scene(text, "bed", changes);
      auto row = run_bed(settings, (small ? 0.5 : 0.4) * settings.duration);
      row["collisions"] = collisions, row["filled_m"] = filled, row["gas_m_per_s"] = speed;
      rows.push_back(row);
    }
  return rows;
}

Json small_cfb(bool small, const std::vector<std::string>& changes) {
  auto settings =
      read_scene(std::filesystem::path(ELROM_SOURCE_DIR) / "examples/11_small_cfb/scene.toml", changes);
  if (small) settings.duration = 0.1;
  return run_bed(settings, 0.5 * settings.duration);
}

}  // namespace elrom::benchmark
