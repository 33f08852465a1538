// Collisions at their exact times. Between forces spheres fly straight, so a step is a row of events in the
// order of time: pairs that touch, spheres that meet a wall. A sphere is moved only when something happens
// to it, and its next events are sought among its neighbours. A step is cut where the list of neighbours
// ends to hold; that changes nothing in what happens.

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/scene/neighbours.hpp"
#include "encounters.hpp"
#include "movers.hpp"
#include "nearest_gap.hpp"

namespace elrom::scene {
namespace {

constexpr double swept_pair_seconds = 1e-9;  // of the list, in a step
constexpr double reserve = 1.05;             // a sphere may become this much faster before the step is cut
constexpr std::int64_t most_events = 20;     // a sphere, in the time it takes to cross the skin; more: jammed
constexpr std::int32_t no_sphere = -1;

struct Event {
  double time;
  std::int32_t i, j;  // no_sphere: a wall
  std::uint32_t stamp_i, stamp_j;
  const Side* side = nullptr;
  // The earliest is the greatest, as a heap wants it.
  bool operator<(const Event& b) const {
    if (time != b.time) return time > b.time;
    return i != b.i ? i > b.i : j > b.j;
  }
};

// What the search for events reads of a sphere, side by side.
struct alignas(64) Flyer {
  Vec place;
  double clock;  // when it is there, from the part's beginning
  Vec velocity;
  double radius;  // of contact with others
};

class Swept final : public Mover {
 public:
  Swept(const Domain& domain, const MoverSettings& settings)
      : domain_(domain), settings_(settings), encounters_(domain, settings) {}

  void advance(State& state, double dt) override {
    auto& p = state.particles;
    if (p.size() == 0) return;
    begin_ = state.time, whole_ = dt;
    gone_.assign(domain_.has_outlets() ? p.size() : 0, 0);
    if (!(greatest_speed_of(p) * dt < HUGE_VAL))
      throw NumericalError(
          Problem{.what = "a sphere's speed is no number any more", .advice = "take a shorter time step"});
    pack(p);
    while (dt > 0) {
      const double fastest = reserve * greatest_speed_of(p);
      if (!fresh_ || (used_ > 0 && used_ + fastest * dt > 0.5 * skin_)) renew(state, fastest * dt);
      const double time = fastest * dt > 0.5 * skin_ - used_ ? (0.5 * skin_ - used_) / fastest : dt;
      const double done = part(state, time, fastest);
      used_ += fastest * done;
      begin_ += done;
      dt = done < dt ? dt - done : 0;
    }
    unpack(p);
    std::ranges::sort(state.leaving);
  }
  void forget() override { fresh_ = false; }
  [[nodiscard]] std::size_t bytes() const override {
    return neighbours_.bytes() + flyers_.capacity() * sizeof(Flyer) + quiet_.capacity() * sizeof(double) +
           stamp_.capacity() * sizeof(std::uint32_t) + near_wall_.capacity() + gone_.capacity() +
           queue_.capacity() * sizeof(Event);
  }

 private:
  void pack(const Particles& p) {
    flyers_.resize(p.size());
    for (std::size_t i = 0; i < p.size(); ++i)
      flyers_[i] = {get(p.place, i), 0, get(p.velocity, i), 0.5 * p.contact_diameter()[i]};
  }
  void unpack(Particles& p) const {
    for (std::size_t i = 0; i < p.size(); ++i) set(p.place, i, flyers_[i].place);
  }

  // A list that holds for the step and some more, but no longer than its pairs are few.
  void renew(State& state, double travel) {
    auto& p = state.particles;
    if (domain_.images().any())
      for (auto& flyer : flyers_) flyer.place = domain_.wrapped(flyer.place);
    unpack(p);
    skin_ = best_skin(p, travel, swept_pair_seconds);
    neighbours_.build(p, domain_, skin_, settings_.n_threads);
    near_wall_.assign(p.size(), 0);
    for (const auto i : neighbours_.near_wall()) near_wall_[static_cast<std::size_t>(i)] = 1;
    quiet_.assign(p.size(), 0);
    stamp_.resize(p.size());
    fresh_ = true;
    used_ = 0;
  }

  // Moves all spheres by `time`, or by less where one has become faster than `fastest`. @return by how much
  double part(State& state, double time, double fastest) {
    auto& p = state.particles;
    first_events(p, time, used_ + fastest * time);
    auto left = most_events * static_cast<std::int64_t>(p.size()) + 1000;
    while (!queue_.empty()) {
      const Event event = pop();
      if (event.time > time) break;
      if (is_stale(event)) continue;
      if (--left < 0) {
        ++state.tally.skipped;
        continue;
      }
      happen(state, event);
      if (is_faster(event.i, fastest) || is_faster(event.j, fastest)) time = event.time;
      for (const auto k : {event.i, event.j})
        if (k != no_sphere) seek(p, static_cast<std::size_t>(k), event.time, time);
    }
    queue_.clear();
    base::parallel_for(
        (p.size() + block_size - 1) / block_size, settings_.n_threads, [&](std::size_t block, int) {
          for (std::size_t i = block * block_size; i < std::min(p.size(), (block + 1) * block_size); ++i)
            bring(state, i, time), flyers_[i].clock = 0;
        });
    return time;
  }

  // @param travelled by any sphere at most, from the making of the list to the end of the part, m
  void first_events(const Particles& p, double time, double travelled) {
    const std::size_t n_blocks = (p.size() + block_size - 1) / block_size;
    found_.resize(n_blocks);
    base::parallel_for(n_blocks, settings_.n_threads, [&](std::size_t block, int) {
      found_[block].clear();
      for (std::size_t i = block * block_size; i < std::min(p.size(), (block + 1) * block_size); ++i)
        if (travelled >= quiet_[i]) quiet_[i] = used_ + first_events_of(p, i, time, found_[block]);
    });
    for (const auto& events : found_) queue_.insert(queue_.end(), events.begin(), events.end());
    std::make_heap(queue_.begin(), queue_.end());
  }
  // @return how far spheres may travel until this one can meet a wall or a partner with a larger number, m
  double first_events_of(const Particles& p, std::size_t i, double time, std::vector<Event>& events) const {
    double room = skin_;
    if (near_wall_[i] != 0) {
      room = std::max(0.0, domain_.room(flyers_[i].place) - 0.5 * p.diameter[i]);
      seek_wall(p, i, 0, time, events);
    }
    NearestGap gap;
    for (const auto number : neighbours_.above(i)) {
      const auto j = static_cast<std::size_t>(number);
      const Vec apart = apart_at(i, j, 0);
      gap.see(dot(apart, apart), reach_of(i, j));
      seek_pair(i, j, apart, 0, time, events);
    }
    return std::min(room, 0.5 * gap.least());
  }

  // What happens to a sphere next, from `now` on.
  void seek(const Particles& p, std::size_t i, double now, double time) {
    if (is_gone(i)) return;
    fresh_events_.clear();
    for (const auto& partners : {neighbours_.below(i), neighbours_.above(i)})
      for (const auto number : partners) {
        const auto j = static_cast<std::size_t>(number);
        seek_pair(i, j, apart_at(i, j, now), now, time, fresh_events_);
      }
    seek_wall(p, i, now, time, fresh_events_);
    for (const auto& event : fresh_events_) {
      queue_.push_back(event);
      std::push_heap(queue_.begin(), queue_.end());
    }
  }

  void seek_pair(std::size_t i, std::size_t j, const Vec& apart, double now, double time,
                 std::vector<Event>& events) const {
    if (is_gone(i) || is_gone(j)) return;
    const Vec closing = flyers_[j].velocity - flyers_[i].velocity;
    const double reach = reach_of(i, j);
    if (!may_meet(apart, closing, reach, time - now)) return;
    const double in = contact_time(apart, closing, reach);
    if (now + in > time) return;
    const std::size_t a = std::min(i, j), b = std::max(i, j);
    events.push_back(
        {now + in, static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), stamp_[a], stamp_[b]});
  }

  void seek_wall(const Particles& p, std::size_t i, double now, double time,
                 std::vector<Event>& events) const {
    if (near_wall_[i] == 0 || is_gone(i)) return;
    const auto exit =
        domain_.first_exit(place_at(i, now), flyers_[i].velocity, 0.5 * p.diameter[i], time - now);
    if (exit.side != nullptr)
      events.push_back({now + exit.time, static_cast<std::int32_t>(i), no_sphere, stamp_[i], 0, exit.side});
  }

  void happen(State& state, const Event& event) {
    auto& p = state.particles;
    const auto i = static_cast<std::size_t>(event.i);
    bring(state, i, event.time);
    ++stamp_[i];
    if (event.j == no_sphere) return meet_wall(state, i, event);
    const auto j = static_cast<std::size_t>(event.j);
    bring(state, j, event.time);
    ++stamp_[j];
    for (const auto k : {i, j}) set(p.place, k, flyers_[k].place);
    encounters_.collide(p, i, j, begin_ + event.time);
    for (const auto k : {i, j}) flyers_[k].velocity = get(p.velocity, k);
    state.count_collision(i, j);
  }

  void meet_wall(State& state, std::size_t i, const Event& event) {
    if (event.side->kind != SideKind::outlet) {
      encounters_.meet_wall(state, i, *event.side, begin_ + event.time);
      flyers_[i].velocity = get(state.particles.velocity, i);
      return;
    }
    gone_[i] = 1;
    state.leaving.push_back(static_cast<std::int32_t>(i));
  }

  Event pop() {
    const Event event = queue_.front();
    std::pop_heap(queue_.begin(), queue_.end());
    queue_.pop_back();
    return event;
  }
  [[nodiscard]] bool is_stale(const Event& event) const {
    return stamp_[static_cast<std::size_t>(event.i)] != event.stamp_i ||
           (event.j != no_sphere && stamp_[static_cast<std::size_t>(event.j)] != event.stamp_j);
  }
  [[nodiscard]] bool is_gone(std::size_t i) const { return !gone_.empty() && gone_[i] != 0; }
  [[nodiscard]] bool is_faster(std::int32_t i, double fastest) const {
    if (i == no_sphere) return false;
    const Vec v = flyers_[static_cast<std::size_t>(i)].velocity;
    return dot(v, v) > fastest * fastest;
  }
  [[nodiscard]] double reach_of(std::size_t i, std::size_t j) const {
    return flyers_[i].radius + flyers_[j].radius;
  }
  [[nodiscard]] Vec apart_at(std::size_t i, std::size_t j, double now) const {
    const Vec apart = place_at(j, now) - place_at(i, now);
    return domain_.images().any() ? domain_.images().nearest(apart) : apart;
  }
  [[nodiscard]] Vec place_at(std::size_t i, double now) const {
    return flyers_[i].place + (now - flyers_[i].clock) * flyers_[i].velocity;
  }
  void bring(State& state, std::size_t i, double now) {
    flyers_[i].place = place_at(i, now);
    flyers_[i].clock = now;
    leave_walls(state, i, domain_, flyers_[i].place, whole_);
  }

  const Domain& domain_;
  MoverSettings settings_;
  Encounters encounters_;
  NeighbourList neighbours_;
  std::vector<Flyer> flyers_;
  bool fresh_ = false;
  double skin_ = 0, used_ = 0;        // of the list: m, and how much of it has been travelled
  double begin_ = 0;                  // of the part, s
  double whole_ = 0;                  // step, s
  std::vector<double> quiet_;         // of each sphere: nothing happens before so much of the list is used, m
  std::vector<std::uint32_t> stamp_;  // events of each sphere so far: older ones are stale
  std::vector<std::uint8_t> near_wall_, gone_;
  std::vector<Event> queue_, fresh_events_;  // a heap
  std::vector<std::vector<Event>> found_;    // by block of spheres
};

}  // namespace

std::unique_ptr<Mover> make_swept(const Domain& domain, const MoverSettings& settings) {
  check(settings.model != nullptr, "swept collisions need a collision model");
  return std::make_unique<Swept>(domain, settings);
}

}  // namespace elrom::scene
