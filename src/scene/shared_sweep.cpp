#include "elrom/scene/shared_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "encounters.hpp"

namespace elrom::scene {
namespace {

constexpr std::int64_t most_shared_events = 20;  // a sphere, in a span; more: jammed
constexpr double no_claim = -1, wall_claim = -2, jammed = -3;
constexpr double too_fast = -1;  // instead of a time
constexpr std::int32_t no_partner = -1;

// What happens to a sphere next.
struct Next {
  double time = never;
  std::int32_t partner = no_partner;  // or a wall:
  const Side* side = nullptr;
};

}  // namespace

class SharedSweep::Impl {
 public:
  Impl(const Domain& domain, const MoverSettings& settings)
      : domain_(domain), encounters_(domain, settings) {}

  bool sweep(State& state, std::size_t n_own, const Partners& partners, const Span& span, Team& team) {
    state_ = &state, n_own_ = n_own, partners_ = &partners, span_ = span, team_ = &team;
    begin();
    for (;;) {
      const double first = team.least(is_too_fast_ ? too_fast : seek());
      if (first == too_fast) return false;
      if (first > span.time) break;
      claim(first);
      happen();
      share();
    }
    for (std::size_t i = 0; i < n_own; ++i) set(p().place, i, place_at(i, 0));
    return true;
  }

 private:
  [[nodiscard]] Particles& p() const { return state_->particles; }

  void begin() {
    clock_.assign(p().size(), 0);
    next_.assign(n_own_, {});
    is_changed_.assign(p().size(), 0);
    is_stale_.assign(n_own_, 1);
    left_ = most_shared_events * static_cast<std::int64_t>(n_own_) + 1000;
    is_too_fast_ = false;
    share();
  }

  // Renews what is next for spheres about which something changed. @return the earliest
  double seek() {
    double earliest = never;
    for (std::size_t i = 0; i < n_own_; ++i) {
      if (is_stale_[i] != 0) next_[i] = next_of(i), is_stale_[i] = 0;
      earliest = std::min(earliest, next_[i].time);
    }
    return earliest;
  }
  // Of events at the same time that with the lowest number, so that partners agree.
  [[nodiscard]] Next next_of(std::size_t i) const {
    Next next;
    const auto exit = domain_.first_exit(get(p().place, i), get(p().velocity, i), 0.5 * p().diameter[i],
                                         span_.time - clock_[i]);
    if (exit.side != nullptr) next = {clock_[i] + exit.time, no_partner, exit.side};
    for (const auto number : partners_->row(i)) {
      const auto j = static_cast<std::size_t>(number);
      const double now = std::max(clock_[i], clock_[j]);
      const double time =
          now + contact_time(apart_at(i, j, now), get(p().velocity, j) - get(p().velocity, i), reach(i, j));
      if (time < next.time || (time == next.time && is_lower(j, next))) next = {time, number, nullptr};
    }
    return next;
  }

  [[nodiscard]] bool is_lower(std::size_t j, const Next& next) const {
    return next.partner != no_partner && p().id[j] < p().id[static_cast<std::size_t>(next.partner)];
  }

  // Says for each own sphere with whom it collides in this round. @param first event of all processes
  void claim(double first) {
    values_.assign(p().size(), left_ > 0 ? no_claim : jammed);
    for (std::size_t i = 0; i < n_own_; ++i) {
      const auto& next = next_[i];
      if (left_ <= 0 || next.time > span_.time || !is_safe(i, first)) continue;
      values_[i] = next.side != nullptr ? wall_claim
                                        : static_cast<double>(p().id[static_cast<std::size_t>(next.partner)]);
    }
    team_->forward(values_, 1);
  }
  // Whether no third sphere can reach this one before its next event. What a sphere does after its clock, and
  // after the first event, is not known; how fast it is at most is.
  [[nodiscard]] bool is_safe(std::size_t i, double first) const {
    const auto& next = next_[i];
    if (next.time <= first) return true;
    const Vec velocity = get(p().velocity, i);
    const double closing = span_.fastest + std::sqrt(dot(velocity, velocity));
    return std::ranges::all_of(partners_->row(i), [&](std::int32_t number) {
      if (number == next.partner) return true;
      const auto k = static_cast<std::size_t>(number);
      const double known = std::max(first, clock_[k]);
      if (next.time <= known) return true;
      const Vec apart = apart_at(i, k, known);
      return std::sqrt(dot(apart, apart)) - reach(i, k) >= closing * (next.time - known);
    });
  }

  void happen() {
    for (std::size_t i = 0; i < n_own_; ++i) {
      const auto& next = next_[i];
      if (next.time > span_.time) continue;
      const auto j = static_cast<std::size_t>(next.partner);
      if (values_[i] == jammed || (next.side == nullptr && values_[j] == jammed))
        skip(i);
      else if (values_[i] == wall_claim)
        meet_wall(i, next);
      else if (values_[i] != no_claim && (j >= n_own_ || i < j) &&
               values_[j] == static_cast<double>(p().id[i]))
        collide(i, j, next.time);
    }
  }
  void meet_wall(std::size_t i, const Next& next) {
    bring(i, next.time);
    encounters_.meet_wall(*state_, i, *next.side, span_.begin + next.time);
    changed(i);
  }
  void collide(std::size_t i, std::size_t j, double time) {
    bring(i, time), bring(j, time);
    const auto [low, high] = p().id[i] < p().id[j] ? std::pair(i, j) : std::pair(j, i);
    encounters_.collide(p(), low, high, span_.begin + time);
    if (low < n_own_) state_->count_collision(low, high);
    changed(i), changed(j);
  }
  // Where too much happens in a span, spheres are jammed, and nothing more happens to them in it.
  void skip(std::size_t i) {
    ++state_->tally.skipped;
    next_[i].time = never;
  }
  void changed(std::size_t i) {
    const Vec v = get(p().velocity, i);
    if (!(dot(v, v) <= span_.fastest * span_.fastest)) is_too_fast_ = true;
    is_changed_[i] = 1;
    --left_;
  }

  // Ghosts become what their owners have made of them.
  void share() {
    const std::size_t width = p().rotates ? 11 : 8;
    values_.resize(p().size() * width);
    for (std::size_t i = 0; i < n_own_; ++i) pack(i, values_.data() + i * width);
    team_->forward(values_, width);
    for (std::size_t i = n_own_; i < p().size(); ++i) {
      const double* from = values_.data() + i * width;
      const Vec before = get(p().velocity, i);
      if (from[6] != clock_[i] || before != Vec{from[3], from[4], from[5]}) is_changed_[i] = 1;
      unpack(i, from);
    }
    for (std::size_t i = 0; i < p().size(); ++i)
      if (is_changed_[i] != 0) make_stale(i);
  }
  void make_stale(std::size_t i) {
    is_changed_[i] = 0;
    if (i < n_own_) is_stale_[i] = 1;
    for (const auto j : partners_->row(i))
      if (static_cast<std::size_t>(j) < n_own_) is_stale_[static_cast<std::size_t>(j)] = 1;
  }
  void pack(std::size_t i, double* to) const {
    for (std::size_t a = 0; a < 3; ++a) to[a] = p().place[a][i], to[3 + a] = p().velocity[a][i];
    to[6] = clock_[i];
    to[7] = p().remembers_hits ? p().last_hit[i] : 0;
    if (p().rotates)
      for (std::size_t a = 0; a < 3; ++a) to[8 + a] = p().spin[a][i];
  }
  void unpack(std::size_t i, const double* from) {
    for (std::size_t a = 0; a < 3; ++a) p().place[a][i] = from[a], p().velocity[a][i] = from[3 + a];
    clock_[i] = from[6];
    if (p().remembers_hits) p().last_hit[i] = from[7];
    if (p().rotates)
      for (std::size_t a = 0; a < 3; ++a) p().spin[a][i] = from[8 + a];
  }

  [[nodiscard]] double reach(std::size_t i, std::size_t j) const { return reach_of(p(), i, j); }
  [[nodiscard]] Vec place_at(std::size_t i, double now) const {
    return get(p().place, i) + (now - clock_[i]) * get(p().velocity, i);
  }
  [[nodiscard]] Vec apart_at(std::size_t i, std::size_t j, double now) const {
    return domain_.images().nearest(place_at(j, now) - place_at(i, now));
  }
  void bring(std::size_t i, double now) {
    set(p().place, i, place_at(i, now));
    clock_[i] = now;
    if (i < n_own_) leave_walls(*state_, i, domain_, get(p().place, i), span_.step);
  }

  const Domain& domain_;
  Encounters encounters_;
  State* state_ = nullptr;
  std::size_t n_own_ = 0;
  const Partners* partners_ = nullptr;
  Span span_;
  Team* team_ = nullptr;
  std::vector<double> clock_;  // of each sphere: when it is where its place says, from the span's beginning
  std::vector<Next> next_;     // of own spheres
  std::vector<std::uint8_t> is_changed_, is_stale_;
  std::vector<double> values_;
  std::int64_t left_ = 0;
  bool is_too_fast_ = false;
};

SharedSweep::SharedSweep(const Domain& domain, const MoverSettings& settings) {
  check(settings.model != nullptr, "swept collisions need a collision model");
  impl_ = std::make_unique<Impl>(domain, settings);
}
SharedSweep::~SharedSweep() = default;

bool SharedSweep::sweep(State& state, std::size_t n_own, const Partners& partners, const Span& span,
                        Team& team) {
  return impl_->sweep(state, n_own, partners, span, team);
}

}  // namespace elrom::scene
