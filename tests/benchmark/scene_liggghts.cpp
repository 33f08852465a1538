#include "scene_liggghts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "elrom/base/text.hpp"
#include "elrom/particle/contact_law.hpp"
#include "elrom/scene/simulation.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::benchmark {
namespace {

using namespace elrom::scene;
using Path = std::filesystem::path;

// In diameters, near the best of those tried on 12,000 crossing spheres. With its own cells, half as wide as
// a pair reaches, it fills the memory once the spheres have flown apart.
constexpr double skin = 1.5, cell = 7;
constexpr int steps_between_counts = 5;  // a contact lasts twenty

std::optional<Path> find_liggghts() {
  const char* path = std::getenv("PATH");
  for (const auto& folder : base::split(path == nullptr ? "" : path, ':'))
    if (const auto file = Path(folder) / "liggghts"; std::filesystem::exists(file)) return file;
  return {};
}

particle::Ball ball_of(const SceneSettings& settings) {
  const auto& group = settings.groups.at(0);
  return {group.diameter, group.density};
}
particle::ContactLaw law_of(const SceneSettings& settings) {
  auto law = settings.contact;
  law.stiffness = settings.stiffness.value();
  return law;
}

// The steps of dem, whose number in a step of the scene is whole.
std::int64_t inner_steps(const SceneSettings& settings) {
  const auto ball = ball_of(settings);
  const double longest = particle::step_times(law_of(settings), 1, ball, ball).step();
  return settings.n_steps() * std::llround(std::ceil(settings.time_step / longest));
}

void write_spheres(const Path& path, const Particles& p) {
  std::string text = fmt::format("spheres\n\n{} atoms\n1 atom types\n\n", p.size());
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = std::ranges::minmax(p.place[a]);
    text += fmt::format("{} {} {}lo {}hi\n", low - 0.001, high + 0.001, "xyz"[a], "xyz"[a]);
  }
  text += "\nAtoms\n\n";
  for (std::size_t i = 0; i < p.size(); ++i)
    text += fmt::format("{} 1 {} {} {} {} {}\n", i + 1, p.diameter[i], p.density[i], p.place[0][i],
                        p.place[1][i], p.place[2][i]);
  text += "\nVelocities\n\n";
  for (std::size_t i = 0; i < p.size(); ++i)
    text += fmt::format("{} {} {} {} 0 0 0\n", i + 1, p.velocity[0][i], p.velocity[1][i], p.velocity[2][i]);
  base::write_text(path, text);
}

// Its damping is over the reduced mass.
std::string input(const SceneSettings& s, const Path& folder, const LiggghtsRun& run, bool counts) {
  const particle::PairContact contact(law_of(s), ball_of(s), ball_of(s));
  const double diameter = ball_of(s).diameter;
  return fmt::format(
      "atom_style granular\natom_modify map array sort 1000 {2}\nboundary m m m\nnewton off\n"
      "communicate single vel yes\nunits si\nread_data {0}\n"
      "neighbor {1} bin\nneigh_modify delay 0 binsize {2}\n"
      "fix kn all property/global kn peratomtypepair 1 {3}\n"
      "fix kt all property/global kt peratomtypepair 1 0\n"
      "fix gn all property/global gamman peratomtypepair 1 {4}\n"
      "fix gt all property/global gammat peratomtypepair 1 0\n"
      "pair_style gran model hooke/stiffness tangential off\npair_coeff * *\n"
      "timestep {5}\nfix move all nve/sphere\nvariable energy equal ke\nthermo_modify norm no\n{6}run {7}\n"
      "print \"energy ${{energy}}\"\n",
      (folder / "spheres").string(), skin * diameter, cell * diameter, contact.stiffness,
      contact.damping / contact.reduced_mass, run.time_step,
      counts ? fmt::format("compute pairs all pair/gran/local id\n"
                           "dump pairs all local {} {} c_pairs[1] c_pairs[2]\n",
                           steps_between_counts, (folder / "pairs").string())
             : "",
      run.steps);
}

rusage run_input(const Path& program, const Path& folder, const std::string& text) {
  base::write_text(folder / "input", text);
  // In its folder: stopped by a signal, it leaves a restart file where it runs.
  return run_program("/usr/bin/env",
                     {"--chdir=" + folder.string(), program.string(), "-in", (folder / "input").string(),
                      "-screen", "none", "-log", (folder / "log").string()});
}

double energy_of(const Path& log) {
  std::ifstream file(log);
  double energy = NAN;
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("energy ")) energy = std::stod(line.substr(7));
  return energy;
}

// Pairs that touch and did not when looked at before.
std::int64_t begun_contacts(const Path& pairs) {
  std::ifstream file(pairs);
  std::set<std::pair<std::int64_t, std::int64_t>> before, now;
  std::int64_t begun = 0;
  std::string line;
  while (std::getline(file, line)) {
    if (line.starts_with("ITEM: TIMESTEP")) before.swap(now), now.clear();
    if (!line.starts_with("ITEM: ENTRIES")) continue;
    while (std::isdigit(file.peek()) != 0 && std::getline(file, line)) {
      std::istringstream row(line);
      std::int64_t i = 0, j = 0;
      row >> i >> j;
      const auto pair = std::minmax(i, j);
      now.insert(pair);
      begun += before.contains(pair) ? 0 : 1;
    }
  }
  return begun;
}

}  // namespace

std::optional<LiggghtsRun> by_liggghts(const SceneSettings& settings) {
  const auto program = find_liggghts();
  if (!program) {
    fmt::print(stderr, "No program liggghts: nothing is run beside dem. Debian's package is liggghts.\n");
    return {};
  }
  const test::TemporaryFolder folder;
  const Simulation simulation(settings, 1);
  const auto& p = simulation.state().particles;
  write_spheres(folder.path() / "spheres", p);
  LiggghtsRun run{.steps = inner_steps(settings)};
  run.time_step = settings.duration / static_cast<double>(run.steps);
  const auto usage = run_input(*program, folder.path(), input(settings, folder.path(), run, false));
  run.seconds = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
  run.energy_ratio = energy_of(folder.path() / "log") / kinetic_energy_of(p);
  run_input(*program, folder.path(), input(settings, folder.path(), run, true));
  run.collisions = begun_contacts(folder.path() / "pairs");
  return run;
}

}  // namespace elrom::benchmark
