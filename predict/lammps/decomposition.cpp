// The one source that knows LAMMPS. Spheres are its atoms of style "sphere", their groups its types, their
// numbers from 1 on its tags; what else they have travels as properties of atoms. A pair style without forces
// asks for the lists; the fix "elrom/forward" hands on what ghosts need.
#include "decomposition.hpp"

#include <mpi.h>

// LAMMPS's utils.h asks for an older fmt than there may be; nothing of it is used.
#define LMP_UTILS_H
#define LAMMPS_LIB_MPI
#include <lammps/atom.h>
#include <lammps/comm.h>
#include <lammps/domain.h>
#include <lammps/fix.h>
#include <lammps/force.h>
#include <lammps/lammps.h>
#include <lammps/library.h>
#include <lammps/modify.h>
#include <lammps/neigh_list.h>
#include <lammps/pair.h>
#include <lammps/update.h>
// Behind LAMMPS's, which bring this one along.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>

#include "elrom/base/error.hpp"

namespace elrom::lammps {
namespace {

using scene::get;
using scene::set;

constexpr std::size_t most_values = 16;  // of an atom, that are handed on at once
// Of atoms, beside what LAMMPS has itself.
enum Property { density, last_hit, touched, push_x, push_y, push_z, n_properties };
constexpr std::array<const char*, n_properties> property_names{"density", "last_hit", "touched",
                                                               "push_x",  "push_y",   "push_z"};

// LAMMPS ends the process where it fails, without a word, since it is told not to write.
bool in_lammps = false;
void say_who_ended() {
  if (in_lammps) std::fprintf(stderr, "error: LAMMPS could not go on and ended the run\n");
}

class Forward final : public LAMMPS_NS::Fix {
 public:
  Forward(LAMMPS_NS::LAMMPS* lammps, int n, char** words) : Fix(lammps, n, words) {
    comm_forward = most_values;
  }
  int setmask() override { return 0; }
  void run(std::span<double> values, std::size_t width) {
    values_ = values, width_ = width;
    comm->forward_comm_fix(this, static_cast<int>(width));
  }
  int pack_forward_comm(int n, int* list, double* to, int, int*) override {
    for (int k = 0; k < n; ++k)
      to = std::copy_n(values_.data() + static_cast<std::size_t>(list[k]) * width_, width_, to);
    return n * static_cast<int>(width_);
  }
  void unpack_forward_comm(int n, int first, double* from) override {
    std::copy_n(from, static_cast<std::size_t>(n) * width_,
                values_.data() + static_cast<std::size_t>(first) * width_);
  }

 private:
  std::span<double> values_;
  std::size_t width_ = 0;
};

LAMMPS_NS::Fix* make_forward(LAMMPS_NS::LAMMPS* lammps, int n, char** words) {
  return new Forward(lammps, n, words);
}

}  // namespace

class Decomposition::Box {
 public:
  Box(const scene::Domain& domain, const scene::State& all) {
    static const int once = std::atexit(say_who_ended);
    (void)once;
    std::array<std::string, 5> words{"elrom", "-screen", "none", "-log", "none"};
    std::array<char*, 5> arguments;
    std::ranges::transform(words, arguments.begin(), [](std::string& word) { return word.data(); });
    lammps_ = static_cast<LAMMPS_NS::LAMMPS*>(
        lammps_open(static_cast<int>(arguments.size()), arguments.data(), MPI_COMM_WORLD, nullptr));
    (*lammps_->modify->fix_map)["elrom/forward"] = &make_forward;
    set_up(domain, all);
    create(all.particles);
  }
  ~Box() { lammps_close(lammps_); }
  Box(const Box&) = delete;
  Box& operator=(const Box&) = delete;

  template <class... T>
  void command(const char* format, const T&... values) {
    in_lammps = true;
    lammps_command(lammps_, fmt::format(fmt::runtime(format), values...).c_str());
    in_lammps = false;
  }

  [[nodiscard]] LAMMPS_NS::Atom& atom() const { return *lammps_->atom; }
  [[nodiscard]] LAMMPS_NS::NeighList& list() const { return *lammps_->force->pair->list; }
  [[nodiscard]] double* property(std::size_t k) const { return atom().dvector[properties_[k]]; }
  void forward(std::span<double> values, std::size_t width) const { forward_->run(values, width); }

  void renew(double skin) {
    // Cells are half as wide as a pair reaches; of spheres that fill little of their box they would be too
    // many.
    const auto& d = *lammps_->domain;
    double volume = 1;
    for (int a = 0; a < 3; ++a) volume *= d.boxhi[a] - d.boxlo[a];
    const double cell =
        std::max(0.5 * (reach_ + skin), std::cbrt(volume / (100.0 * static_cast<double>(atom().natoms))));
    command("neighbor {:.17g} bin", skin);
    command("neigh_modify binsize {:.17g}", cell);
    command("run 0 post no");
  }
  // LAMMPS's own command "timestep" is heard only by a run that sets up everything.
  void run_step(double time) {
    lammps_->update->dt = time;
    move_->reset_dt();
    command("run 1 pre no post no");
  }

 private:
  void set_up(const scene::Domain& domain, const scene::State& all) {
    const auto& p = all.particles;
    reach_ = *std::ranges::max_element(p.diameter);
    std::string boundary, box;
    const auto period = array_of(domain.images().period);
    for (std::size_t a = 0; a < 3; ++a) {
      const bool is_periodic = period[a] > 0;
      const auto [least, most] = std::ranges::minmax(p.place[a]);
      const double low = is_periodic ? array_of(domain.low())[a] : least - reach_;
      const double high = is_periodic ? array_of(domain.high())[a] : most + reach_;
      boundary += is_periodic ? " p" : " m";  // grows and shrinks with the spheres, but not to nothing
      box += fmt::format(" {:.17g} {:.17g}", low, high);
    }
    command("units si");
    command("atom_style sphere");
    command("atom_modify map array sort 0 0");
    command("boundary{}", boundary);
    command("newton off");
    command("comm_modify vel yes");
    command("region all block{}", box);
    command("create_box {} all", all.n_groups);
    command("pair_style zero {:.17g}", reach_);
    command("pair_coeff * *");
    command("neigh_modify delay 0 once yes");
    std::string names;
    for (const auto* name : property_names) names += std::string(" d_") + name;
    command("fix properties all property/atom{} ghost yes", names);
    command("fix forward all elrom/forward");
    command("fix move all nve");
    command("thermo_style custom step");
    move_ = lammps_->modify->fix[lammps_->modify->find_fix("move")];
    forward_ = static_cast<Forward*>(lammps_->modify->fix[lammps_->modify->find_fix("forward")]);
    for (std::size_t k = 0; k < n_properties; ++k) {
      int is_real = 0, n_columns = 0;
      properties_[k] = atom().find_custom(property_names[k], is_real, n_columns);
    }
  }

  // Each process takes those in its part.
  void create(const scene::Particles& p) {
    const std::size_t n = p.size();
    std::vector<int> tags(n), types(n);
    std::vector<double> places(3 * n), velocities(3 * n);
    for (std::size_t i = 0; i < n; ++i) {
      tags[i] = static_cast<int>(p.id[i]) + 1, types[i] = p.group[i] + 1;
      for (std::size_t a = 0; a < 3; ++a)
        places[3 * i + a] = p.place[a][i], velocities[3 * i + a] = p.velocity[a][i];
    }
    in_lammps = true;
    lammps_create_atoms(lammps_, static_cast<int>(n), tags.data(), types.data(), places.data(),
                        velocities.data(), nullptr, 0);
    in_lammps = false;
    check(atom().natoms == static_cast<std::int64_t>(n), "LAMMPS takes all spheres");
  }

  LAMMPS_NS::LAMMPS* lammps_;
  LAMMPS_NS::Fix* move_ = nullptr;
  Forward* forward_ = nullptr;
  double reach_ = 0;  // of a pair, m
  std::array<int, n_properties> properties_{};
};

Decomposition::Decomposition(const scene::Domain& domain, const scene::State& all)
    : box_(std::make_unique<Box>(domain, all)) {
  state_.set_groups(static_cast<std::size_t>(all.n_groups));
  auto& p = state_.particles;
  p.rotates = all.particles.rotates, p.remembers_hits = all.particles.remembers_hits;
  p.remembers_walls = all.particles.remembers_walls;
  const auto& atom = box_->atom();
  n_own_ = static_cast<std::size_t>(atom.nlocal);
  is_pushed_ = !all.push[0].empty();
  if (is_pushed_)
    for (auto& component : state_.push) component.resize(n_own_);
  for (std::size_t i = 0; i < n_own_; ++i) {
    const auto k = static_cast<std::size_t>(
        std::ranges::lower_bound(all.particles.id, std::int64_t{atom.tag[i]} - 1) - all.particles.id.begin());
    p.add(all.particles.sphere(k));
    atom.radius[i] = 0.5 * p.diameter[i], atom.rmass[i] = p.mass[i];
    box_->property(density)[i] = p.density[i];
    if (p.remembers_hits) p.last_hit[i] = all.particles.last_hit[k];
    if (p.remembers_walls) p.touched[i] = all.particles.touched[k];
    if (p.rotates) set(p.spin, i, get(all.particles.spin, k));
    if (is_pushed_) set(state_.push, i, get(all.push, k));
  }
}
Decomposition::~Decomposition() = default;

void Decomposition::keep() {
  const auto& atom = box_->atom();
  const auto& p = state_.particles;
  for (std::size_t i = 0; i < n_own_; ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      atom.x[i][a] = p.place[a][i], atom.v[i][a] = p.velocity[a][i];
      if (p.rotates) atom.omega[i][a] = p.spin[a][i];
      if (is_pushed_) box_->property(push_x + a)[i] = state_.push[a][i];
    }
    if (p.remembers_hits) box_->property(last_hit)[i] = p.last_hit[i];
    if (p.remembers_walls) box_->property(touched)[i] = static_cast<double>(p.touched[i]);
  }
}

void Decomposition::restore() {
  const auto& atom = box_->atom();
  auto& p = state_.particles;
  n_own_ = static_cast<std::size_t>(atom.nlocal);
  const auto n = static_cast<std::size_t>(atom.nlocal + atom.nghost);
  p.keep_only({});
  for (std::size_t i = 0; i < n; ++i) {
    p.add({{atom.x[i][0], atom.x[i][1], atom.x[i][2]},
           {atom.v[i][0], atom.v[i][1], atom.v[i][2]},
           2 * atom.radius[i],
           box_->property(density)[i],
           std::int64_t{atom.tag[i]} - 1,
           atom.type[i] - 1});
    if (p.remembers_hits) p.last_hit[i] = box_->property(last_hit)[i];
    if (p.remembers_walls) p.touched[i] = static_cast<std::uint64_t>(box_->property(touched)[i]);
    if (p.rotates) set(p.spin, i, {atom.omega[i][0], atom.omega[i][1], atom.omega[i][2]});
  }
  for (std::size_t a = 0; a < 3 && is_pushed_; ++a)
    state_.push[a].assign(box_->property(push_x + a), box_->property(push_x + a) + n_own_);
}

void Decomposition::renew(double skin) {
  keep();
  box_->renew(skin);
  restore();
  list_partners();
}

// A pair that crosses the period is one of its own process, or of the first ghost of its number.
void Decomposition::list_partners() {
  const auto& list = box_->list();
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  auto& begin = partners_.begin;
  begin.assign(state_.particles.size() + 1, 0);
  for (int k = 0; k < list.inum; ++k) {
    const int i = list.ilist[k];
    for (int m = 0; m < list.numneigh[i]; ++m) {
      const int j = box_->atom().map(box_->atom().tag[list.firstneigh[i][m] & NEIGHMASK]);
      if (j == i) continue;
      pairs.emplace_back(i, j);
      ++begin[static_cast<std::size_t>(i) + 1], ++begin[static_cast<std::size_t>(j) + 1];
    }
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  partners_.of.resize(begin.back());
  auto next = begin;
  for (const auto& [i, j] : pairs) {
    partners_.of[next[static_cast<std::size_t>(i)]++] = j;
    partners_.of[next[static_cast<std::size_t>(j)]++] = i;
  }
}

void Decomposition::fly(double time) {
  keep();
  box_->run_step(time);
  for (std::size_t i = 0; i < n_own_; ++i)
    for (std::size_t a = 0; a < 3; ++a) state_.particles.place[a][i] = box_->atom().x[i][a];
}

void Decomposition::forward(std::span<double> values, std::size_t width) {
  check(width <= most_values, "LAMMPS hands on so many values of a sphere");
  box_->forward(values, width);
}

double Decomposition::least(double value) {
  double least = 0;
  MPI_Allreduce(&value, &least, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
  return least;
}

}  // namespace elrom::lammps
