// bench-scenes: counts of collisions over time steps by each model, soft spheres as the yardstick; Haff's
// law; energy; sphere steps a second.
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>
#include <numeric>

#include "elrom/particle/drag.hpp"
#include "elrom/scene/simulation.hpp"
#include "scene_beds.hpp"
#include "scene_lammps.hpp"
#include "scene_liggghts.hpp"
#include "support/benchmark.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::ordered_json;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Outcome {
  double seconds = 0, collisions = 0, energy_ratio = 0, momentum_change = 0, gain = 0;
  std::size_t spheres = 0;
};

// Two streams that cross at 20 degrees off the axis, 10 m/s.
// @param twin another run of the same: a speed that differs in its 13th digit
std::string crossing(int number, const std::string& collisions, double step, int twin = 0,
                     double duration = 0.012) {
  const double edge = 0.0145 * std::cbrt(number / 12000.0);
  const auto region = [&](const char* name, double low, double high) {
    return std::string("\n[[regions]]\nname = \"") + name + "\"\nlow = [" + std::to_string(low) +
           ", 0, 0]\nhigh = [" + std::to_string(high) + ", " + std::to_string(edge) + ", " +
           std::to_string(edge) + "]\n";
  };
  const auto group = [&](const char* name, double u) {
    return std::string("\n[[particles]]\ngroup = \"") + name + "\"\nregion = \"" + name +
           "\"\ndiameter = \"315 um\"\nnumber = " + std::to_string(number / 2) + "\nvelocity = [" +
           fmt::format("{:.14g}", u) + ", 3.42, 0]\n";
  };
  return "[scene]\nname = \"crossing\"\nduration = " + std::to_string(duration) +
         "\ntime_step = " + std::to_string(step * 1e9) + "e-9\n[effects]\ncollisions = \"" + collisions +
         "\"\n[collisions]\nrestitution = 0.9\nstiffness = 5000\n" + region("left", 0, 2 * edge) +
         region("right", 2.2 * edge, 4.2 * edge) + group("left", 9.4 + twin * 2e-12) + group("right", -9.4);
}

Outcome run(const std::string& text) {
  scene::Simulation simulation(scene::parse_scene(text, "bench"), 1);
  const auto& p = simulation.state().particles;
  const double energy = kinetic_energy_of(p);
  const scene::Vec momentum = momentum_of(p);
  Outcome out{.spheres = p.size()};
  double before = energy, speed_mass = 0;
  for (std::size_t i = 0; i < p.size(); ++i)
    speed_mass += p.mass[i] * std::sqrt(dot(scene::get(p.velocity, i), scene::get(p.velocity, i)));
  const double begin = processor_seconds();
  double checking = 0;
  while (!simulation.done()) {
    simulation.step();
    const double at = processor_seconds(), now = kinetic_energy_of(p);
    out.gain = std::max(out.gain, now / before - 1);
    before = now;
    checking += processor_seconds() - at;
  }
  out.seconds = processor_seconds() - begin - checking;
  const scene::Vec change = momentum_of(p) - momentum;
  out.momentum_change = std::sqrt(dot(change, change)) / speed_mass;
  out.collisions = static_cast<double>(simulation.state().tally.collisions);
  out.energy_ratio = kinetic_energy_of(p) / energy;
  return out;
}

// Counts of chaotic runs differ by chance: means over twins tell whether the step matters.
Json counts_by_step(int number, int twins) {
  Json rows = Json::array();
  for (const double step : {1e-3, 1e-4, 1e-5}) {
    std::vector<double> counts;
    for (int twin = 0; twin < twins; ++twin)
      counts.push_back(run(crossing(number, "helscm", step, twin)).collisions);
    const double mean = std::accumulate(counts.begin(), counts.end(), 0.0) / twins;
    double squared = 0;
    for (const double count : counts) squared += (count - mean) * (count - mean) / (twins - 1);
    rows.push_back(
        {{"time_step_s", step}, {"twins", twins}, {"mean", mean}, {"deviation", std::sqrt(squared)}});
  }
  return rows;
}

Json json_of(const std::string& model, double step, const Outcome& out, double yardstick) {
  return {{"model", model},
          {"time_step_s", step},
          {"seconds", out.seconds},
          {"collisions", out.collisions},
          {"to_dem", out.collisions / yardstick},
          {"energy_ratio", out.energy_ratio},
          {"greatest_energy_gain_in_a_step", out.gain},
          {"momentum_change", out.momentum_change}};
}

Json crossing_streams(bool small) {
  const int number = small ? 800 : 12000;
  Json table = Json::array();
  const auto dem = run(crossing(number, "dem", 1e-4));
  table.push_back(json_of("dem", 1e-4, dem, dem.collisions));
  for (const double step : {1e-3, 1e-4, 1e-5, 1e-6})
    table.push_back(json_of("helscm", step, run(crossing(number, "helscm", step)), dem.collisions));
  for (const double step : {1e-3, 1e-4, 7.14e-5, 1e-5})
    table.push_back(
        json_of("helscm_document", step, run(crossing(number, "helscm_document", step)), dem.collisions));
  return table;
}

// MFiX-Exa's homogeneous cooling, in CGS: 5050 spheres of 0.01 cm in a cube of 64 diameters, temperature
// 1000 cm2/s2. Time is in d / sqrt(T) of the temperature that was drawn.
// @return temperatures at these times, over that at the start
std::vector<double> cooled(const std::string& collisions, double restitution,
                           const std::vector<double>& times, int seed) {
  const double diameter = 1e-4, speed = std::sqrt(0.1), unit = diameter / speed;  // m, m/s, s
  scene::Simulation simulation(
      scene::parse_scene(
          fmt::format("[scene]\nduration = {}\ntime_step = {}\nseed = {}\n"
                      "[domain]\nperiodic = [\"x\", \"y\", \"z\"]\n[effects]\ncollisions = \"{}\"\n"
                      "[collisions]\ncontact_time = 0\nrestitution = {}\n"
                      "[[domain.boxes]]\nname = \"cube\"\nlow = [0, 0, 0]\nhigh = [0.0064, 0.0064, 0.0064]\n"
                      "[[particles]]\ngroup = \"a\"\ndiameter = 1e-4\nnumber = 5050\nscatter = {}\n",
                      1.1 * times.back() * unit, 0.25 * unit, seed, collisions, restitution, speed),
          "haff"),
      1);
  const auto temperature = [&] {
    return 2 * kinetic_energy_of(simulation.state().particles) / 3 / mass_of(simulation.state().particles);
  };
  const double start = temperature(), own_unit = diameter / std::sqrt(start);
  double last_time = 0, last = start;
  std::vector<double> found;
  while (found.size() < times.size() && !simulation.done()) {
    simulation.step();
    const double time = simulation.state().time, now = temperature();
    for (; found.size() < times.size() && time >= times[found.size()] * own_unit;) {
      const double share = (times[found.size()] * own_unit - last_time) / (time - last_time);
      found.push_back((last + share * (now - last)) / start);
    }
    last_time = time, last = now;
  }
  return found;
}

// Means over draws of the spheres, and their deviation.
Json haff(const std::string& collisions, double restitution, const std::vector<double>& times, int draws) {
  const auto expected = restitution == 0.8 ? std::vector{0.983438, 0.851252, 0.638403, 0.295837}
                                           : std::vector{0.991210, 0.917064, 0.779390, 0.480650};
  std::vector<double> sum(times.size()), squares(times.size());
  const double begin = processor_seconds();
  for (int seed = 1; seed <= draws; ++seed) {
    const auto found = cooled(collisions, restitution, times, seed);
    for (std::size_t k = 0; k < times.size(); ++k) sum[k] += found.at(k), squares[k] += found[k] * found[k];
  }
  Json rows = Json::array();
  for (std::size_t k = 0; k < times.size(); ++k) {
    const double mean = sum[k] / draws, law = expected[k];
    const double variance = draws > 1 ? (squares[k] - draws * mean * mean) / (draws - 1) : 0;
    rows.push_back({{"t", times[k]},
                    {"haff", law},
                    {"found", mean},
                    {"error", mean / law - 1},
                    {"deviation_of_a_draw", std::sqrt(std::max(0.0, variance)) / law}});
  }
  return {{"collisions", collisions},
          {"restitution", restitution},
          {"draws", draws},
          {"seconds", processor_seconds() - begin},
          {"rows", rows}};
}

Json all_haff(bool small) {
  Json table = Json::array();
  const std::vector<double> times = small ? std::vector<double>{1, 10} : std::vector<double>{1, 10, 30, 100};
  for (const double restitution : {0.8, 0.9}) {
    table.push_back(haff("helscm", restitution, times, small ? 1 : 16));
    if (!small) table.push_back(haff("dem", restitution, times, 8));
  }
  return table;
}

void measure_streams(bool small, Json& json) {
  const Json table = crossing_streams(small);  // of its own: a reference would not outlive the next key
  json["crossing_streams"] = table;
  const double seconds_dem = table[0]["seconds"];
  json["dem_seconds_over_swept_seconds"] = seconds_dem / table[1]["seconds"].get<double>();
  double least = HUGE_VAL, most = 0;
  for (std::size_t k = 1; k <= 4; ++k) {
    least = std::min(least, table[k]["collisions"].get<double>());
    most = std::max(most, table[k]["collisions"].get<double>());
  }
  json["helscm_spread_of_counts"] = most / least - 1;
  json["helscm_counts_of_twins"] = counts_by_step(small ? 800 : 12000, 4);
  const double n = small ? 800 : 12000;
  json["swept_sphere_steps_per_second"] = n * 12000 / table[4]["seconds"].get<double>();
}

Json many_spheres(int number) {
  const auto out = run(crossing(number, "helscm", 1e-3, 0, 0.004));  // they have met after 0.7 ms
  return {{"spheres", out.spheres},
          {"seconds", out.seconds},
          {"collisions", out.collisions},
          {"energy_ratio", out.energy_ratio},
          {"greatest_energy_gain_in_a_step", out.gain},
          {"momentum_change", out.momentum_change}};
}

// Both by the same law in the same steps, one after the other on one core.
void measure_liggghts(bool small, Json& json) {
  const auto text = crossing(small ? 800 : 12000, "dem", 1e-4);
  const auto theirs = benchmark::by_liggghts(scene::parse_scene(text, "bench"));
  if (!theirs) return;
  const auto ours = run(text);
  json["liggghts"] = {{"steps", theirs->steps},
                      {"time_step_s", theirs->time_step},
                      {"collisions", theirs->collisions},
                      {"energy_ratio", theirs->energy_ratio},
                      {"dem_collisions", ours.collisions},
                      {"dem_energy_ratio", ours.energy_ratio},
                      {"dem_seconds", ours.seconds}};
  json["liggghts_seconds"] = theirs->seconds;
  json["dem_speedup"] = theirs->seconds / ours.seconds;
}

void measure(const std::string& part, const benchmark::Arguments& arguments,
             const std::vector<std::string>& changes, Json& json) {
  if (part == "streams")
    measure_streams(arguments.small, json);
  else if (part == "haff")
    json["haff"] = all_haff(arguments.small);
  else if (part == "liggghts")
    measure_liggghts(arguments.small, json);
  else if (part == "lammps")
    json["lammps"] = benchmark::by_lammps(crossing(arguments.small ? 800 : 12000, "helscm", 1e-4));
  else if (part == "million")
    json["million"] = many_spheres(arguments.small ? 50'000 : 1'000'000);
  else if (part == "beds")
    json["beds"] = benchmark::straight_beds(arguments.small, "hel", changes);
  else if (part == "beds_dem")
    json["beds_dem"] = benchmark::straight_beds(arguments.small, "dem", changes);
  else if (part == "cfb")
    json["cfb"] = benchmark::small_cfb(arguments.small, changes);
  else
    throw UsageError(Problem{.what = "unknown part", .found = "'" + part + "'"});
}

}  // namespace

int main(int argc, char** argv) {
  using namespace elrom;
  return base::run_app("bench-scenes", [&] {
    benchmark::CommandLine line("Spheres in scenes: counts, energy, pressure, seconds by model and step.");
    benchmark::Arguments arguments;
    arguments.add_to(line, "not used");
    std::vector<std::string> parts{"streams", "haff", "liggghts", "lammps"}, changes;
    line.add_list("--parts", parts, "streams, haff, liggghts, lammps, million, beds, beds_dem, cfb");
    line.add_repeated("--set", changes, "key=value: a setting of the scenes of files; repeatable");
    if (const auto status = line.parse(argc, argv)) return *status;
    Json json;
    for (const auto& part : parts) measure(part, arguments, changes, json);
    return benchmark::show(std::move(json), arguments.small, arguments.json);
  });
}
