// The state of a scene as a tensor file, and back.

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/scene/simulation.hpp"

namespace elrom::scene {
namespace {

// Whole numbers up to 2^53 are exact.
std::vector<double> reals(const auto& values) { return {values.begin(), values.end()}; }

io::Tensor row(const std::vector<double>& values) { return io::Tensor::copy(values, {values.size()}); }

std::vector<double> read_row(const io::TensorFile& file, const std::string& name, std::size_t n) {
  const auto values = file.tensor(name, std::array{n}).f64();
  return {values.begin(), values.end()};
}

template <class T>
std::vector<T> read_whole(const io::TensorFile& file, const std::string& name, std::size_t n) {
  std::vector<T> whole;
  for (const double value : read_row(file, name, n)) {
    if (!(std::abs(value) < 9e15) || value != std::floor(value))
      throw InputError(Problem{
          .what = "a damaged checkpoint", .where = file.where() + ":" + name, .expected = "whole numbers"});
    whole.push_back(static_cast<T>(value));
  }
  return whole;
}

constexpr std::array<const char*, 3> axes{"x", "y", "z"};

void set_vectors(io::TensorFile& file, const std::string& name, const Vectors& vectors) {
  for (std::size_t a = 0; a < 3; ++a) file.set(name + "_" + axes[a], row(vectors[a]));
}

void read_vectors(const io::TensorFile& file, const std::string& name, std::size_t n, Vectors& vectors) {
  for (std::size_t a = 0; a < 3; ++a) {
    vectors[a] = read_row(file, name + "_" + axes[a], n);
    for (const double value : vectors[a])
      if (!std::isfinite(value))
        throw InputError(Problem{.what = "a damaged checkpoint",
                                 .where = file.where() + ":" + name,
                                 .expected = "finite numbers"});
  }
}

Particles particles_of(const std::vector<Sphere>& spheres, bool are_parcels) {
  Particles particles;
  particles.are_parcels = are_parcels;
  for (const auto& sphere : spheres) particles.add(sphere);
  return particles;
}

void set_particles(io::TensorFile& file, const std::string& prefix, const Particles& p) {
  set_vectors(file, prefix + "place", p.place);
  set_vectors(file, prefix + "velocity", p.velocity);
  if (p.rotates) set_vectors(file, prefix + "spin", p.spin);
  file.set(prefix + "diameter", row(p.diameter));
  file.set(prefix + "density", row(p.density));
  if (p.are_parcels) file.set(prefix + "weight", row(p.weight));
  file.set(prefix + "id", row(reals(p.id)));
  file.set(prefix + "group", row(reals(p.group)));
  if (p.remembers_hits) file.set(prefix + "last_hit", row(p.last_hit));
  if (p.remembers_birth) file.set(prefix + "born", row(p.born));
  if (p.remembers_walls) file.set(prefix + "touched", row(reals(p.touched)));
}

// @param p says whether spheres rotate and remember
Particles read_particles(const io::TensorFile& file, const std::string& prefix, std::int32_t n_groups,
                         Particles p) {
  const auto n = file.tensor(prefix + "diameter", std::array{io::any_size}).size();
  read_vectors(file, prefix + "place", n, p.place);
  read_vectors(file, prefix + "velocity", n, p.velocity);
  if (p.rotates) read_vectors(file, prefix + "spin", n, p.spin);
  p.diameter = read_row(file, prefix + "diameter", n);
  p.density = read_row(file, prefix + "density", n);
  p.id = read_whole<std::int64_t>(file, prefix + "id", n);
  p.group = read_whole<std::int32_t>(file, prefix + "group", n);
  if (p.remembers_hits) p.last_hit = read_row(file, prefix + "last_hit", n);
  if (p.remembers_birth) p.born = read_row(file, prefix + "born", n);
  if (p.remembers_walls)
    p.touched = file.has(prefix + "touched") ? read_whole<std::uint64_t>(file, prefix + "touched", n)
                                             : std::vector<std::uint64_t>(n);
  if (p.are_parcels) p.weight = read_row(file, prefix + "weight", n);
  p.mass.clear(), p.contact.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const double weight = p.are_parcels ? p.weight[i] : 1;
    const bool is_sphere = weight > 0 && weight < 1e15 && p.diameter[i] > 0 && p.density[i] > 0 &&
                           p.diameter[i] < 1e3 && p.density[i] < 1e9 && p.group[i] >= 0 &&
                           p.group[i] < n_groups;
    if (!is_sphere)
      throw InputError(
          Problem{.what = "a damaged checkpoint", .where = file.where(), .expected = "spheres of the scene"});
    p.mass.push_back(weight * particle::sphere_mass(p.diameter[i], p.density[i]));
    if (p.are_parcels) p.contact.push_back(p.diameter[i] * std::sqrt(weight));
  }
  return p;
}

constexpr std::size_t n_counts = 9;

std::vector<double> counts_of(const State& s) {
  const auto& t = s.tally;
  return {static_cast<double>(s.step),      static_cast<double>(s.next_id), static_cast<double>(t.collisions),
          static_cast<double>(t.wall_hits), static_cast<double>(t.left),    static_cast<double>(t.returned),
          static_cast<double>(t.added),     static_cast<double>(t.skipped), s.time};
}

// Of all groups one after another: counts of the bins, and the sum.
std::vector<double> residence_row(const std::vector<ResidenceTimes>& groups) {
  std::vector<double> values;
  for (const auto& times : groups) {
    values.insert(values.end(), times.counts.begin(), times.counts.end());
    values.push_back(times.sum);
  }
  return values;
}

void read_residence(const std::vector<double>& values, std::vector<ResidenceTimes>& groups) {
  auto at = values.begin();
  for (auto& times : groups) {
    for (auto& count : times.counts) count = static_cast<std::int64_t>(*at++);
    times.sum = *at++;
  }
}

}  // namespace

io::TensorFile Simulation::save() {
  // A list of neighbours is not kept, so the run that goes on makes its own anew, as the one that is loaded
  // does.
  mover_->forget();
  io::TensorFile file;
  io::write_kind(file, io::kinds::scene_checkpoint);
  file.set_text("scene", digest_of(settings_));
  set_particles(file, "", state_.particles);
  set_particles(file, "waiting_", particles_of(state_.waiting, state_.particles.are_parcels));
  file.set("counts", row(counts_of(state_)));
  file.set("collisions_by_groups", row(reals(state_.tally.by_groups)));
  file.set("wall_hits_by_group", row(reals(state_.tally.wall_hits_by_group)));
  file.set("residence", row(residence_row(state_.tally.residence)));
  file.set("placed", row(reals(placed_)));
  mover_->save(file);
  for (const auto& timed : effects_) timed.effect->save(file);
  return file;
}

void Simulation::load(const io::TensorFile& file) {
  io::check_kind(file, io::kinds::scene_checkpoint);
  if (file.text("scene") != digest_of(settings_))
    throw InputError(Problem{.what = "the checkpoint belongs to another scene",
                             .where = file.where(),
                             .advice = "use another --output, or remove it to begin anew"});
  State state = std::move(state_);
  Particles empty;
  empty.rotates = settings_.rotation;
  empty.remembers_hits = state.particles.remembers_hits;
  empty.are_parcels = state.particles.are_parcels;
  empty.remembers_birth = state.particles.remembers_birth;
  empty.remembers_walls = state.particles.remembers_walls;
  state.particles = read_particles(file, "", state.n_groups, empty);
  state.waiting.clear();
  const auto waiting = read_particles(file, "waiting_", state.n_groups, particles_of({}, empty.are_parcels));
  for (std::size_t i = 0; i < waiting.size(); ++i) state.waiting.push_back(waiting.sphere(i));
  const auto counts = read_row(file, "counts", n_counts);
  const auto whole = [&](std::size_t k) { return static_cast<std::int64_t>(counts[k]); };
  state.step = whole(0), state.next_id = whole(1), state.time = counts[8];
  auto& t = state.tally;
  t.collisions = whole(2), t.wall_hits = whole(3), t.left = whole(4);
  t.returned = whole(5), t.added = whole(6), t.skipped = whole(7);
  t.by_groups = read_whole<std::int64_t>(file, "collisions_by_groups", t.by_groups.size());
  t.wall_hits_by_group = read_whole<std::int64_t>(file, "wall_hits_by_group", t.wall_hits_by_group.size());
  read_residence(read_row(file, "residence", t.residence.size() * (ResidenceTimes::n_bins + 1)), t.residence);
  const auto placed = read_whole<std::int64_t>(file, "placed", placed_.size());
  std::ranges::copy(placed, placed_.begin());  // effects hold on to the places
  state_ = std::move(state);
  for (auto& timed : effects_) timed.effect->load(file);
  mover_->load(file);
  mover_->forget();
}

}  // namespace elrom::scene
