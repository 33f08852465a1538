#include "elrom/scene/scene_run.hpp"

#include <fmt/format.h>

#include <cmath>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/scene/neighbours.hpp"

namespace elrom::scene {
namespace {

using std::filesystem::path;

std::string joined(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + base::number(value);
  return text + "\n";
}

std::string series_heading(const Simulation& simulation) {
  std::string text =
      "time [s],spheres,waiting,mass [kg],momentum_x [kg m/s],momentum_y [kg m/s],momentum_z [kg m/s],"
      "kinetic_energy [J],greatest_speed [m/s],collisions,wall_hits,left,returned";
  const auto& names = simulation.group_names();
  for (const auto& name : names)
    text += "," + io::csv_cell("number of " + name) + "," + io::csv_cell("mean height of " + name + " [m]");
  for (std::size_t a = 0; a < names.size(); ++a)
    for (std::size_t b = a; b < names.size(); ++b)
      text += "," + io::csv_cell("collisions of " + names[a] + " and " + names[b]);
  if (simulation.flow() != nullptr)
    text += ",gas pressure at inlets [Pa],gas flow in [m3/s],gas flow out [m3/s],gas divergence";
  return text + "\n";
}

std::string series_row(const Simulation& simulation) {
  const auto& s = simulation.state();
  const auto& p = s.particles;
  const Vec momentum = momentum_of(p);
  std::vector<double> row{s.time,
                          static_cast<double>(p.size()),
                          static_cast<double>(s.waiting.size()),
                          mass_of(p),
                          momentum.x,
                          momentum.y,
                          momentum.z,
                          kinetic_energy_of(p),
                          greatest_speed_of(p)};
  for (const auto count : {s.tally.collisions, s.tally.wall_hits, s.tally.left, s.tally.returned})
    row.push_back(static_cast<double>(count));
  const auto n_groups = simulation.group_names().size();
  std::vector<double> numbers(n_groups), heights(n_groups);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto g = static_cast<std::size_t>(p.group[i]);
    ++numbers[g];
    heights[g] += p.place[2][i];
  }
  for (std::size_t g = 0; g < n_groups; ++g)
    row.insert(row.end(), {numbers[g], numbers[g] > 0 ? heights[g] / numbers[g] : 0});
  for (std::size_t a = 0; a < n_groups; ++a)
    for (std::size_t b = a; b < n_groups; ++b)
      row.push_back(static_cast<double>(s.tally.by_groups[a * n_groups + b]));
  if (const auto* flow = simulation.flow())
    row.insert(row.end(), {flow->inlet_pressure(), flow->flow_in(), flow->flow_out(), flow->divergence()});
  return joined(row);
}

std::string section_heading(const Simulation& simulation) {
  return std::string(
             "time [s],x [m],y [m],z [m],number,mass [kg],volume_fraction,velocity_x [m/s],velocity_y "
             "[m/s],velocity_z [m/s]") +
         (simulation.flow() != nullptr ? ",gas_pressure [Pa]" : "") + "\n";
}

struct CellSums {
  double number = 0, mass = 0, volume = 0;
  Vec momentum;
  double gas_volume = 0, pressure = 0;  // pressure times volume
};

/// The cells of a section, x fastest.
class SectionCells {
 public:
  explicit SectionCells(const SectionSettings& section) : low_(section.low) {
    const Vec size = section.high - section.low;
    const std::array<double, 3> sizes{size.x, size.y, size.z};
    for (std::size_t a = 0; a < 3; ++a) {
      count_[a] = static_cast<std::size_t>(section.cells[a]);
      step_[a] = sizes[a] / static_cast<double>(count_[a]);
    }
  }
  [[nodiscard]] std::size_t size() const { return count_[0] * count_[1] * count_[2]; }
  [[nodiscard]] double volume() const { return step_[0] * step_[1] * step_[2]; }
  /// Of a place; none outside.
  [[nodiscard]] std::optional<std::size_t> find(const Vec& place) const {
    const Vec at = place - low_;
    const std::array<double, 3> along{at.x / step_[0], at.y / step_[1], at.z / step_[2]};
    for (std::size_t a = 0; a < 3; ++a)
      if (!(along[a] >= 0 && along[a] < static_cast<double>(count_[a]))) return {};
    return static_cast<std::size_t>(along[0]) +
           count_[0] * (static_cast<std::size_t>(along[1]) + count_[1] * static_cast<std::size_t>(along[2]));
  }
  [[nodiscard]] Vec centre(std::size_t cell) const {
    const auto along = [&](std::size_t index, std::size_t a) {
      return (static_cast<double>(index) + 0.5) * step_[a];
    };
    return low_ + Vec{along(cell % count_[0], 0), along(cell / count_[0] % count_[1], 1),
                      along(cell / count_[0] / count_[1], 2)};
  }

 private:
  Vec low_;
  std::array<std::size_t, 3> count_{};
  std::array<double, 3> step_{};
};

// A text of a checkpoint that grows with the run: as a tensor, since a header is short.
io::Tensor as_tensor(const std::string& text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return io::Tensor::copy(std::span(bytes), {bytes.size()});
}

std::string read_text(const io::TensorFile& file, const std::string& name) {
  const auto tensor = file.tensor(name, std::array{io::any_size});
  const auto bytes = tensor.u8();
  return {bytes.begin(), bytes.end()};
}

// By where the centres are: of the spheres, and of the gas's cells.
std::string section_rows(const SectionSettings& section, const Simulation& simulation) {
  const auto& state = simulation.state();
  const auto& p = state.particles;
  const SectionCells places(section);
  std::vector<CellSums> cells(places.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    const auto at = places.find(simulation.domain().wrapped(get(p.place, i)));
    if (!at) continue;
    auto& cell = cells[*at];
    ++cell.number;
    cell.mass += p.mass[i];
    cell.volume += p.mass[i] / p.density[i];
    cell.momentum += p.mass[i] * get(p.velocity, i);
  }
  const auto* flow = simulation.flow();
  for (std::size_t c = 0; flow != nullptr && c < flow->grid().size(); ++c) {
    const auto at = flow->grid().is_open(c) ? places.find(flow->grid().centre(c)) : std::nullopt;
    if (!at) continue;
    cells[*at].gas_volume += flow->grid().space(c);
    cells[*at].pressure += flow->grid().space(c) * flow->pressure()[c];
  }
  std::string text;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const auto& c = cells[k];
    const Vec place = places.centre(k);
    const Vec velocity = c.mass > 0 ? (1 / c.mass) * c.momentum : Vec{};
    std::vector<double> row{
        state.time, place.x,    place.y,   place.z, c.number, c.mass, c.volume / places.volume(),
        velocity.x, velocity.y, velocity.z};
    if (flow != nullptr) row.push_back(c.gas_volume > 0 ? c.pressure / c.gas_volume : 0);
    text += joined(row);
  }
  return text;
}

std::string residence_table(const Simulation& simulation) {
  std::string text = "group,from [s],to [s],number\n";
  const auto& groups = simulation.state().tally.residence;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t bin = 0; bin < ResidenceTimes::n_bins; ++bin)
      if (groups[g].counts[bin] > 0)
        text += io::csv_cell(simulation.group_names()[g]) + "," +
                joined({ResidenceTimes::edge(bin), ResidenceTimes::edge(bin + 1),
                        static_cast<double>(groups[g].counts[bin])});
  return text;
}

// The tables of a run, kept in its checkpoint so that they go on where it does.
class Outputs {
 public:
  Outputs(const Simulation& simulation, path folder) : simulation_(simulation), folder_(std::move(folder)) {
    series_ = series_heading(simulation);
    sections_.assign(simulation.settings().sections.size(), section_heading(simulation));
  }

  void add_rows() {
    series_ += series_row(simulation_);
    const auto& s = simulation_.settings();
    for (std::size_t k = 0; k < sections_.size(); ++k)
      sections_[k] += section_rows(s.sections[k], simulation_);
    if (std::ranges::find(s.formats, "vtp") == s.formats.end()) return;
    const auto name = fmt::format("particles_{:012}.vtp", simulation_.state().step);
    write_vtp(folder_ / name, simulation_.state().particles, simulation_.domain());
    movie_ +=
        fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", base::number(simulation_.state().time), name);
  }

  std::vector<std::string> write() const {
    std::vector<std::string> files;
    const auto put = [&](const std::string& name, const std::string& text) {
      base::write_text(folder_ / name, text);
      files.push_back((folder_ / name).string());
    };
    put("series.csv", series_);
    for (std::size_t k = 0; k < sections_.size(); ++k)
      put("section_" + simulation_.settings().sections[k].name + ".csv", sections_[k]);
    if (simulation_.domain().has_outlets()) put("residence.csv", residence_table(simulation_));
    if (!movie_.empty())
      put("particles.pvd",
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n" + movie_ +
              "</Collection>\n</VTKFile>\n");
    return files;
  }

  void save(io::TensorFile& file) const {
    file.set("series", as_tensor(series_));
    file.set("movie", as_tensor(movie_));
    for (std::size_t k = 0; k < sections_.size(); ++k)
      file.set(fmt::format("section_{}", k), as_tensor(sections_[k]));
  }
  void load(const io::TensorFile& file) {
    series_ = read_text(file, "series");
    movie_ = read_text(file, "movie");
    for (std::size_t k = 0; k < sections_.size(); ++k)
      sections_[k] = read_text(file, fmt::format("section_{}", k));
  }

 private:
  const Simulation& simulation_;
  path folder_;
  std::string series_, movie_;
  std::vector<std::string> sections_;
};

void keep(Simulation& simulation, const Outputs& outputs, const path& file) {
  auto saved = simulation.save();
  outputs.save(saved);
  saved.write(file);
}

void expect_sound(const Simulation& simulation) {
  const auto& p = simulation.state().particles;
  const auto overlaps = overlaps_of(p, simulation.domain(), 0.01, 1);
  if (overlaps.n > 0)
    throw UsageError(Problem{.what = fmt::format("{} pairs of spheres overlap at the start", overlaps.n),
                             .expected = "spheres apart"});
}

}  // namespace

SceneRun run(Simulation& simulation, const path& folder, Log& log, const std::stop_token& stop) {
  std::filesystem::create_directories(folder);
  const path file = folder / "checkpoint.elrom";
  const base::FileLock lock(base::lock_beside(file));
  base::remove_remains(file);
  const auto& settings = simulation.settings();
  Outputs outputs(simulation, folder);
  SceneRun done;
  if (std::filesystem::exists(file)) {
    const auto saved = io::TensorFile::open(file, io::Verify::on_use);
    simulation.load(saved);
    outputs.load(saved);
    done.resumed_from = simulation.state().step;
  } else {
    expect_sound(simulation);
    base::write_text(folder / "scene.toml", to_toml(settings));
    outputs.add_rows();
  }
  const auto every = settings.steps_in(settings.output_every),
             keep_every = settings.steps_in(settings.checkpoint_every);
  const base::Stopwatch watch;
  while (!simulation.done()) {
    if (stop.stop_requested())
      throw Interrupted(Problem{.what = "stopped",
                                .advice = "run the same command again to go on from the last checkpoint"});
    simulation.step();
    ++done.steps;
    const auto step = simulation.state().step;
    const bool shows = step % every == 0 || simulation.done(),
               keeps = step % keep_every == 0 || simulation.done();
    if (shows || keeps) simulation.gather();
    if (shows) outputs.add_rows();
    if (keeps) {
      keep(simulation, outputs, file);
      outputs.write();
    }
    log.progress({.task = settings.name, .done = step, .total = settings.n_steps(), .unit = "steps"});
  }
  done.seconds = watch.seconds();
  done.files = outputs.write();
  return done;
}

}  // namespace elrom::scene
