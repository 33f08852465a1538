#include "shared_mover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "decomposition.hpp"
#include "elrom/base/error.hpp"
#include "elrom/scene/neighbours.hpp"

namespace elrom::lammps {
namespace {

using scene::dot;
using scene::get;
using scene::Particles;
using scene::set;
using scene::State;

constexpr double reserve = 1.2;        // a sphere may become this much faster in a span of time
constexpr double pair_seconds = 1e-7;  // of the list, in a step: LAMMPS makes long ones slowly

// Spheres on their way: a row each.
constexpr std::size_t row_width = 18;

void add_row(std::vector<double>& rows, const State& state, std::size_t i) {
  const auto& p = state.particles;
  const auto vector = [&](const scene::Vectors& v) {
    for (const auto& component : v) rows.push_back(component.empty() ? 0 : component[i]);
  };
  rows.insert(rows.end(), {static_cast<double>(p.id[i]), static_cast<double>(p.group[i]), p.diameter[i],
                           p.density[i], p.remembers_hits ? p.last_hit[i] : 0,
                           p.remembers_walls ? static_cast<double>(p.touched[i]) : 0});
  vector(p.place), vector(p.velocity), vector(p.spin), vector(state.push);
}

scene::Vec vector_in(const double* row, std::size_t at) { return {row[at], row[at + 1], row[at + 2]}; }

// In the order of their numbers. @param state says what spheres remember, and whether they are pushed
void read_rows(const std::vector<double>& rows, State& state, bool is_pushed) {
  auto& p = state.particles;
  p.keep_only({});
  const std::size_t n = rows.size() / row_width;
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](std::size_t k) { return rows[k * row_width]; });
  for (auto& component : state.push) component.assign(is_pushed ? n : 0, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const double* row = rows.data() + order[i] * row_width;
    p.add({vector_in(row, 6), vector_in(row, 9), row[2], row[3], static_cast<std::int64_t>(row[0]),
           static_cast<std::int32_t>(row[1])});
    if (p.remembers_hits) p.last_hit[i] = row[4];
    if (p.remembers_walls) p.touched[i] = static_cast<std::uint64_t>(row[5]);
    if (p.rotates) set(p.spin, i, vector_in(row, 12));
    if (is_pushed) set(state.push, i, vector_in(row, 15));
  }
}

double greatest_speed(const Particles& p, std::size_t n) {
  double squared = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = get(p.velocity, i);
    if (!std::isfinite(dot(v, v))) return HUGE_VAL;
    squared = std::max(squared, dot(v, v));
  }
  return std::sqrt(squared);
}

class SharedMover final : public scene::Mover {
 public:
  SharedMover(Job& job, const scene::Domain& domain, const scene::MoverSettings& settings)
      : job_(job), domain_(domain), sweep_(domain, settings) {}

  void advance(State& state, double dt) override {
    if (job_.leads()) job_.order(Order::step, state.time);
    bool is_sound = true;
    try {
      is_sound = move(state, dt);
    } catch (const std::exception& error) {
      job_.abort(error.what());  // the others would wait for ever
    }
    if (!is_sound && job_.leads())
      throw NumericalError(
          Problem{.what = "a sphere's speed is no number any more", .advice = "take a shorter time step"});
  }

  void gather(State& state) override {
    if (job_.leads()) job_.order(Order::gather, state.time);
    if (parts_ == nullptr) return;
    std::vector<double> rows;
    for (std::size_t i = 0; i < state.particles.size(); ++i) add_row(rows, state, i);
    read_rows(job_.gathered(rows), state, !state.push[0].empty());
    auto& t = state.tally;
    for (auto* count : {&t.collisions, &t.wall_hits, &t.skipped}) job_.sum({count, 1});
    for (auto* counts : {&t.by_groups, &t.wall_hits_by_group}) job_.sum(*counts);
    parts_ = nullptr;
  }

 private:
  // @return false, at all processes, when a speed is no number
  bool move(State& state, double dt) {
    if (parts_ == nullptr)
      share(state);
    else
      take(state);
    if (parts_ == nullptr) return true;
    double slack = reserve;
    for (double done = 0; done < dt;) {
      const double left = dt - done;
      const double fastest =
          -slack * parts_->least(-greatest_speed(parts_->state().particles, parts_->n_own()));
      if (!(fastest * left < HUGE_VAL)) return false;
      renew_for(fastest * left);
      const double room = 0.5 * skin_ - used_, time = fastest * left > room ? room / fastest : left;
      if (!pass({.begin = job_.now() + done, .time = time, .step = dt, .fastest = fastest})) {
        slack *= 2;
        continue;
      }
      used_ += fastest * time;
      done = time < left ? done + time : dt;
      slack = reserve;
    }
    give(state);
    return true;
  }

  // Lists that hold for so much travel, m, and some more, but no longer than their pairs are few.
  void renew_for(double travel) {
    if (skin_ > 0 && (used_ == 0 || used_ + travel <= 0.5 * skin_)) return;
    auto& p = parts_->state().particles;
    skin_ = parts_->least(parts_->n_own() > 0 ? scene::best_skin(p, travel, pair_seconds) : HUGE_VAL);
    parts_->renew(skin_);
    used_ = 0;
  }

  // @return false, at all processes, when a sphere became too fast: all is as before
  bool pass(const scene::Span& span) {
    parts_->keep();
    const auto tally = parts_->state().tally;
    if (!sweep_.sweep(parts_->state(), parts_->n_own(), parts_->partners(), span, *parts_)) {
      parts_->restore();
      parts_->state().tally = tally;
      return false;
    }
    parts_->fly(span.time);
    return true;
  }

  // Rank 0 has all spheres; each process gets those of its part.
  void share(const State& state) {
    std::vector<double> rows, pushed{state.push[0].empty() ? 0.0 : 1.0};
    if (job_.leads())
      for (std::size_t i = 0; i < state.particles.size(); ++i) add_row(rows, state, i);
    job_.broadcast(rows);
    job_.broadcast(pushed);
    if (rows.empty()) return;
    State all = state;
    read_rows(rows, all, pushed[0] > 0);
    for (std::size_t i = 0; i < all.particles.size(); ++i)
      set(all.particles.place, i, domain_.wrapped(get(all.particles.place, i)));
    parts_ = std::make_unique<Decomposition>(domain_, all);
    parts_->state().tally = state.tally;
    skin_ = used_ = 0;
  }

  // What forces have made of own spheres since the last step.
  void take(const State& state) {
    auto& own = parts_->state();
    const auto copy = [&](const scene::Vectors& from, scene::Vectors& to) {
      for (std::size_t a = 0; a < 3; ++a) std::ranges::copy(from[a], to[a].begin());
    };
    copy(state.particles.velocity, own.particles.velocity);
    if (!own.push[0].empty()) copy(state.push, own.push);
  }
  void give(State& state) const {
    state.particles = parts_->state().particles;
    std::vector<std::uint8_t> is_own(state.particles.size(), 0);
    std::fill_n(is_own.begin(), parts_->n_own(), std::uint8_t{1});
    state.particles.keep_only(is_own);
    state.tally = parts_->state().tally;
  }

  Job& job_;
  const scene::Domain& domain_;
  scene::SharedSweep sweep_;
  std::unique_ptr<Decomposition> parts_;  // null: rank 0 has all spheres
  double skin_ = 0, used_ = 0;            // of the lists: m, and how much of it has been travelled
};

}  // namespace

std::unique_ptr<scene::Mover> make_shared_mover(Job& job, const scene::Domain& domain,
                                                const scene::MoverSettings& settings) {
  return std::make_unique<SharedMover>(job, domain, settings);
}

}  // namespace elrom::lammps
