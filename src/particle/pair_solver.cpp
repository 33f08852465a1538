#include "elrom/particle/pair_solver.hpp"

#include <cmath>

#include "elrom/base/parallel.hpp"
#include "lanes.hpp"

namespace elrom::particle {
namespace {

constexpr std::size_t pairs_a_thread = 512;  // pairs a thread takes at a time

// Of the relative motion: see the header. `place` counts from where the
// contact begins, so that an overlap of 1e-16 m keeps its digits.
struct State {
  LaneVector place, velocity, spin, spring;

  State& add(const Lane& factor, const State& rate) {
    place += factor * rate.place;
    velocity += factor * rate.velocity;
    spin += factor * rate.spin;
    spring += factor * rate.spring;
    return *this;
  }
};

State choose(const Mask& mask, const State& yes, const State& no) {
  return {select(mask, yes.place, no.place), select(mask, yes.velocity, no.velocity),
          select(mask, yes.spin, no.spin), select(mask, yes.spring, no.spring)};
}

constexpr double shortest_step = 1.0 / 128;  // of a usual one

// Constants of the pairs in the lanes.
struct Constants {
  Lane reduced_mass, distance, stiffness, damping, tangential_stiffness, tangential_damping, friction, step;
  Lane diameter_1, diameter_2, mass_1, mass_2;
  LaneVector start;  // centre of 2 from that of 1, m
  Lane start_gap;    // R^2 - |start|^2
};

// Where a cubic through both ends of a step, with the rates
// given there, falls to zero; as a share of the step.
Lane root(const Lane& value_0, const Lane& rate_0, const Lane& value_1, const Lane& rate_1) {
  Lane low = 0.0, high = 1.0;
  for (int i = 0; i < 40; ++i) {
    const Lane x = 0.5 * (low + high), y = 1 - x;
    const Lane value =
        y * y * ((1 + 2 * x) * value_0 + x * rate_0) + x * x * ((1 + 2 * y) * value_1 - y * rate_1);
    const Mask above = value > 0;
    low = select(above, x, low);
    high = select(above, high, x);
  }
  return high;
}

template <LawKind law, bool rough>
class Contact {
 public:
  explicit Contact(const Constants& constants) : c_(constants), per_mass_(1 / constants.reduced_mass) {}

  [[nodiscard]] Lane overlap(const State& state) const {
    const LaneVector place = c_.start + state.place;
    return overlap_at(state, sqrt(dot(place, place)));
  }
  // Of the overlap.
  [[nodiscard]] Lane rate(const State& state) const {
    const LaneVector place = c_.start + state.place;
    return -dot(place, state.velocity) / sqrt(dot(place, place));
  }
  [[nodiscard]] LaneVector normal(const State& state) const {
    const LaneVector place = c_.start + state.place;
    return (1 / sqrt(dot(place, place))) * place;
  }

  [[nodiscard]] State advance(const State& state, const Lane& step) const {
    const Lane loaded = law == LawKind::hertz && rough ? sqrt(max(overlap(state), Lane(0.0))) : Lane(1.0);
    const auto k1 = derivative(state, loaded);
    const auto k2 = derivative(State(state).add(0.5 * step, k1), loaded);
    const auto k3 = derivative(State(state).add(0.5 * step, k2), loaded);
    const auto k4 = derivative(State(state).add(step, k3), loaded);
    State next = state;
    next.add(step / 6, k1).add(step / 3, k2).add(step / 3, k3).add(step / 6, k4);
    if constexpr (rough) settle_spring(next, loaded);
    return next;
  }

 private:
  struct Forces {
    Lane distance, normal;
    Lane spring_power, damper_power;  // overlap to the powers of the tangential law
    LaneVector direction;
  };

  // R - distance, without the difference of nearly equal numbers.
  [[nodiscard]] Lane overlap_at(const State& state, const Lane& distance) const {
    const Lane gap = c_.start_gap - 2 * dot(c_.start, state.place) - dot(state.place, state.place);
    return gap / (c_.distance + distance);
  }

  [[nodiscard]] Forces forces(const State& state) const {
    Forces f;
    const LaneVector place = c_.start + state.place;
    f.distance = sqrt(dot(place, place));
    f.direction = (1 / f.distance) * place;
    const Lane overlap = max(overlap_at(state, f.distance), Lane(0.0));
    const Lane closing = -dot(f.direction, state.velocity);
    if constexpr (law == LawKind::linear) {
      f.normal = c_.stiffness * overlap + c_.damping * closing;
      f.spring_power = f.damper_power = 1.0;
    } else {
      f.spring_power = sqrt(overlap);
      f.damper_power = sqrt(f.spring_power);
      f.normal = c_.stiffness * overlap * f.spring_power + c_.damping * f.damper_power * closing;
    }
    return f;
  }

  // Largest friction now: none where the damper pulls.
  [[nodiscard]] Lane limit(const Forces& f) const { return c_.friction * max(f.normal, Lane(0.0)); }

  static LaneVector cut(const LaneVector& force, const Lane& most) {
    const Lane size = sqrt(dot(force, force));
    return select(size > most, most / size, Lane(1.0)) * force;
  }

  // What is left of a spring's force that was there at the
  // step's beginning, where sqrt(overlap) was `loaded`.
  [[nodiscard]] static Lane kept(const Forces& f, const Lane& loaded) {
    if constexpr (law == LawKind::linear) return 1.0;
    return select(f.spring_power < loaded, f.spring_power / loaded, Lane(1.0));
  }

  // `spring` within a step: the force as it was at `loaded`, so
  // that its rate stays finite where spheres part.
  [[nodiscard]] State derivative(const State& state, const Lane& loaded) const {
    const auto f = forces(state);
    State rate;
    rate.place = state.velocity;
    rate.velocity = (f.normal * per_mass_) * f.direction;
    if constexpr (rough) {
      const Lane lever = f.distance / c_.distance;
      const LaneVector across = state.velocity - dot(state.velocity, f.direction) * f.direction;
      const LaneVector slip = across - lever * cross(state.spin, f.direction);
      // The spring alone is cut first: one that slides follows the limit within the step.
      const Lane most = limit(f);
      const LaneVector force = cut(
          cut(kept(f, loaded) * state.spring, most) + (c_.tangential_damping * f.damper_power) * slip, most);
      rate.velocity -= per_mass_ * force;
      rate.spin = (2.5 * per_mass_ * lever) * cross(f.direction, force);
      rate.spring = (c_.tangential_stiffness * max(f.spring_power, loaded)) * slip -
                    (dot(state.spring, across) / f.distance) * f.direction;
    } else {
      rate.spin = rate.spring = {0.0, 0.0, 0.0};
    }
    return rate;
  }

  // The spring lies across the normal, has lost what its stiffness
  // lost, and slides where it would pull more than friction.
  void settle_spring(State& after, const Lane& loaded) const {
    const auto f = forces(after);
    after.spring -= dot(after.spring, f.direction) * f.direction;
    after.spring = cut(kept(f, loaded) * after.spring, limit(f));
  }

  const Constants& c_;
  Lane per_mass_;
};

// A few pairs, in the lanes, from touching to parting.
template <LawKind law, bool rough>
class Group {
 public:
  Group(const Pairs& pairs, std::size_t first, const Constants& constants)
      : c_(constants), contact_(c_), mass_share_1_(c_.reduced_mass / c_.mass_1) {
    const auto velocity_1 = load_vector(pairs.before.velocity_1, first);
    const auto velocity_2 = load_vector(pairs.before.velocity_2, first);
    const Lane overlap = load(pairs.overlap, first);
    c_.start = (c_.distance - overlap) * load_vector(pairs.normal, first);
    c_.start_gap = overlap * (2 * c_.distance - overlap);
    begin_.place = {0.0, 0.0, 0.0};
    begin_.velocity = velocity_2 - velocity_1;
    begin_.spin = (0.5 * c_.diameter_1) * load_vector(pairs.before.spin_1, first) +
                  (0.5 * c_.diameter_2) * load_vector(pairs.before.spin_2, first);
    begin_.spring = {0.0, 0.0, 0.0};
    state_ = begin_;
    const Mask there =
        Lane([](auto lane) { return static_cast<double>(lane); }) < static_cast<double>(pairs.size() - first);
    active_ =
        there && c_.step > 0 && (overlap > 0 || dot(load_vector(pairs.normal, first), begin_.velocity) < 0);
    greatest_ = select(active_, overlap, Lane(0.0));
    duration_ = 0.0;
  }

  /// @return pair-steps done
  double run(int most_steps) {
    double done = 0;
    for (int step = 0; step < most_steps && any_of(active_); ++step) {
      done += std::experimental::popcount(active_);
      advance();
    }
    return done;
  }

  // Pairs that never parted lose their normal velocity.
  int stop_rest() {
    const LaneVector normal = contact_.normal(state_);
    state_.velocity =
        select(active_, state_.velocity - dot(state_.velocity, normal) * normal, state_.velocity);
    return std::experimental::popcount(active_);
  }

  void store_into(const Pairs& pairs, std::size_t first, Parting& parting) const {
    const LaneVector change = state_.velocity - begin_.velocity, turn = state_.spin - begin_.spin;
    const Lane share_1 = mass_share_1_, share_2 = c_.reduced_mass / c_.mass_2;
    store(load_vector(pairs.before.velocity_1, first) - share_1 * change, parting.after.velocity_1, first);
    store(load_vector(pairs.before.velocity_2, first) + share_2 * change, parting.after.velocity_2, first);
    store(load_vector(pairs.before.spin_1, first) + (2 * share_1 / c_.diameter_1) * turn,
          parting.after.spin_1, first);
    store(load_vector(pairs.before.spin_2, first) + (2 * share_2 / c_.diameter_2) * turn,
          parting.after.spin_2, first);
    store(greatest_, parting.overlap, first);
    store(duration_, parting.duration, first);
  }

 private:
  // Hertz's damper goes with the fourth root of the overlap, so steps are
  // short where spheres begin to touch and where they part.
  [[nodiscard]] Lane step_now() const {
    if constexpr (law == LawKind::linear) return c_.step;
    const Lane rate = contact_.rate(state_);
    return min(c_.step, max(shortest_step * c_.step, 0.5 * contact_.overlap(state_) / max(rate, -rate)));
  }

  void advance() {
    const Lane step = step_now();
    const State next = contact_.advance(state_, step);
    const Lane now = contact_.overlap(state_), then = contact_.overlap(next);
    const Lane rate_now = contact_.rate(state_) * step, rate_then = contact_.rate(next) * step;
    // The peak of a step that turns round.
    const Mask turns = rate_now > 0 && rate_then < 0;
    const Lane peak = now + 0.5 * rate_now * rate_now / (rate_now - rate_then);
    greatest_ = select(active_, max(greatest_, max(then, select(turns, peak, then))), greatest_);
    const Mask parts = active_ && then <= 0;
    Lane share = 1.0;
    if (any_of(parts)) share = select(parts, root(now, rate_now, then, rate_then), share);
    const State end = any_of(parts) ? contact_.advance(state_, share * step) : next;
    // Numbers too small or too large to calculate with: the pair is left as it was.
    const Mask lost = active_ && !(then > 0) && !parts;
    state_ = choose(lost, begin_, choose(active_, end, state_));
    duration_ = select(active_, duration_ + share * step, duration_);
    active_ = active_ && then > 0;
  }

  Constants c_;
  Contact<law, rough> contact_;
  Lane mass_share_1_;
  State begin_, state_;
  Mask active_;
  Lane greatest_, duration_;
};

// Step of a pair: a share of the contact's duration, of a straight
// path's through the overlap, and what the rules allow.
double step_of(const ContactLaw& law, const PairContact& contact, const Ball& one, const Ball& two,
               double closing, double speed_squared, double overlap, int steps_per_contact) {
  // An overlap at the start is worth the speed that its spring will give.
  const double from_spring = 2 * contact.spring_energy(overlap) / contact.reduced_mass;
  const double speed = std::sqrt(closing * closing + from_spring);
  if (!(speed > 0)) return 0;
  double longest = contact.duration(speed);
  if (overlap == 0) longest = std::min(longest, 2 * contact.distance * closing / speed_squared);
  return std::min(longest / steps_per_contact, step_times(law, speed, one, two).step());
}

Constants constants_of(const Pairs& pairs, const ContactLaw& law, std::size_t first, int steps_per_contact) {
  Constants c;
  c.friction = law.friction;
  const auto n = pairs.size();
  for (std::size_t lane = 0; lane < lane_width; ++lane) {
    const auto i = static_cast<Eigen::Index>(std::min(first + lane, n - 1));
    const Ball one{pairs.diameter_1[i], pairs.density_1[i]}, two{pairs.diameter_2[i], pairs.density_2[i]};
    const PairContact contact(law, one, two);
    const auto velocity = (pairs.before.velocity_2.row(i) - pairs.before.velocity_1.row(i)).eval();
    const double closing = std::max(0.0, -(velocity * pairs.normal.row(i)).sum());
    c.reduced_mass[lane] = contact.reduced_mass;
    c.distance[lane] = contact.distance;
    c.stiffness[lane] = contact.stiffness;
    c.damping[lane] = contact.damping;
    c.tangential_stiffness[lane] = contact.tangential_stiffness;
    c.tangential_damping[lane] = contact.tangential_damping;
    c.step[lane] = step_of(law, contact, one, two, closing, velocity.square().sum(), pairs.overlap[i],
                           steps_per_contact);
    c.diameter_1[lane] = one.diameter;
    c.diameter_2[lane] = two.diameter;
    c.mass_1[lane] = sphere_mass(one.diameter, one.density);
    c.mass_2[lane] = sphere_mass(two.diameter, two.density);
  }
  return c;
}

struct BlockResult {
  double steps = 0;
  std::size_t stayed = 0;
};

template <LawKind law, bool rough>
BlockResult run_block(const Pairs& pairs, const ContactLaw& contact, const PairSolverOptions& options,
                      std::size_t first, std::size_t end, Parting& parting) {
  BlockResult result;
  for (; first < end; first += lane_width) {
    Group<law, rough> group(pairs, first, constants_of(pairs, contact, first, options.steps_per_contact));
    result.steps += group.run(options.most_steps);
    result.stayed += static_cast<std::size_t>(group.stop_rest());
    group.store_into(pairs, first, parting);
  }
  return result;
}

auto block_runner(const ContactLaw& law) {
  const bool rough = law.friction > 0;
  if (law.kind == LawKind::linear)
    return rough ? run_block<LawKind::linear, true> : run_block<LawKind::linear, false>;
  return rough ? run_block<LawKind::hertz, true> : run_block<LawKind::hertz, false>;
}

}  // namespace

Parting collide(const Pairs& pairs, const ContactLaw& law, const PairSolverOptions& options,
                const std::stop_token& stop) {
  law.check();
  const auto n = pairs.size();
  Parting parting;
  parting.after = Motion(n);
  parting.overlap = parting.duration = Scalars::Zero(static_cast<Eigen::Index>(n));
  const std::size_t n_blocks = (n + pairs_a_thread - 1) / pairs_a_thread;
  std::vector<BlockResult> results(n_blocks);
  const auto run = block_runner(law);
  base::parallel_for(
      n_blocks, options.n_threads,
      [&](std::size_t block, int) {
        const auto first = block * pairs_a_thread;
        results[block] = run(pairs, law, options, first, std::min(n, first + pairs_a_thread), parting);
      },
      stop);
  for (const auto& result : results) {
    parting.pair_steps += result.steps;
    parting.n_stayed += result.stayed;
  }
  return parting;
}

}  // namespace elrom::particle
