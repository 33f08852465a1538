#include "elrom/scene/shared_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

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
    for (std::size_t i = 0; i < n_own; ++i) {
      leave_walls(state, i, domain_, place_at(i, span.time), span.step);
      set(p().place, i, place_at(i, 0));
    }
    return true;
  }

 private:
  [[nodiscard]] Particles& p() const { return state_->particles; }

  void begin() {
    clock_.assign(p().size(), 0);
    next_.assign(n_own_, {});
    claims_.assign(p().size(), no_claim);
    width_ = p().rotates ? 11 : 8;
    states_.resize(p().size() * width_);
    for (std::size_t i = 0; i < n_own_; ++i) pack(i);
    busy_.clear(), changed_.clear();
    share();
    stale_.resize(n_own_);
    std::iota(stale_.begin(), stale_.end(), 0);
    is_stale_.assign(n_own_, 1);
    left_ = most_shared_events * static_cast<std::int64_t>(n_own_) + 1000;
    is_too_fast_ = false;
  }

  // Renews what is next for spheres about which something changed. @return the earliest
  double seek() {
    std::erase_if(busy_,
                  [&](std::int32_t i) { return is_stale_[at(i)] != 0 || next_[at(i)].time > span_.time; });
    for (const auto i : stale_) {
      next_[at(i)] = next_of(at(i));
      is_stale_[at(i)] = 0;
      if (next_[at(i)].time <= span_.time) busy_.push_back(i);
    }
    stale_.clear();
    double earliest = never;
    for (const auto i : busy_) earliest = std::min(earliest, next_[at(i)].time);
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
    return next.partner != no_partner && p().id[j] < p().id[at(next.partner)];
  }

  // Says for each own sphere with whom it collides in this round. @param first event of all processes
  void claim(double first) {
    if (left_ <= 0) std::fill_n(claims_.begin(), n_own_, jammed);
    for (const auto number : busy_) {
      const auto i = at(number);
      if (claims_[i] == jammed) continue;
      const auto& next = next_[i];
      claims_[i] = !is_safe(i, first)     ? no_claim
                   : next.side != nullptr ? wall_claim
                                          : static_cast<double>(p().id[at(next.partner)]);
    }
    team_->forward(claims_, 1);
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
    for (const auto number : busy_) {
      const auto i = at(number);
      const auto& next = next_[i];
      if (claims_[i] == jammed || (next.side == nullptr && claims_[at(next.partner)] == jammed))
        skip(i);
      else if (claims_[i] == wall_claim)
        meet_wall(i, next);
      else if (claims_[i] != no_claim && is_agreed(i, at(next.partner)))
        collide(i, at(next.partner), next.time);
    }
    for (const auto i : busy_)
      if (claims_[at(i)] != jammed) claims_[at(i)] = no_claim;
  }
  // Of two own spheres the first one speaks.
  [[nodiscard]] bool is_agreed(std::size_t i, std::size_t j) const {
    return (j >= n_own_ || i < j) && claims_[j] == static_cast<double>(p().id[i]);
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
    changed_.push_back(static_cast<std::int32_t>(i));
    if (i < n_own_) pack(i);
    --left_;
  }

  // Ghosts become what their owners have made of them.
  void share() {
    team_->forward(states_, width_);
    for (std::size_t i = n_own_; i < p().size(); ++i)
      if (unpack(i)) changed_.push_back(static_cast<std::int32_t>(i));
    for (const auto i : changed_) {
      make_stale(i);
      for (const auto j : partners_->row(at(i))) make_stale(j);
    }
    changed_.clear();
  }
  void make_stale(std::int32_t i) {
    if (at(i) >= n_own_ || is_stale_[at(i)] != 0) return;
    is_stale_[at(i)] = 1;
    stale_.push_back(i);
  }
  void pack(std::size_t i) {
    double* to = states_.data() + i * width_;
    for (std::size_t a = 0; a < 3; ++a) to[a] = p().place[a][i], to[3 + a] = p().velocity[a][i];
    to[6] = clock_[i];
    to[7] = p().remembers_hits ? p().last_hit[i] : 0;
    if (p().rotates)
      for (std::size_t a = 0; a < 3; ++a) to[8 + a] = p().spin[a][i];
  }
  // @return whether its path is another one
  bool unpack(std::size_t i) {
    const double* from = states_.data() + i * width_;
    const Vec velocity{from[3], from[4], from[5]};
    const bool is_new = from[6] != clock_[i] || velocity != get(p().velocity, i);
    set(p().place, i, {from[0], from[1], from[2]});
    set(p().velocity, i, velocity);
    clock_[i] = from[6];
    if (p().remembers_hits) p().last_hit[i] = from[7];
    if (p().rotates) set(p().spin, i, {from[8], from[9], from[10]});
    return is_new;
  }

  [[nodiscard]] static std::size_t at(std::int32_t i) { return static_cast<std::size_t>(i); }
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
  std::vector<std::int32_t> busy_;     // own spheres to which something happens in the span
  std::vector<std::int32_t> changed_;  // in this round
  std::vector<std::int32_t> stale_;    // own spheres whose next event is to be sought again
  std::vector<std::uint8_t> is_stale_;
  std::vector<double> claims_, states_;  // what is handed on
  std::size_t width_ = 0;                // of a state
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
