// Spheres that several processes share, here threads: what happens to them is what happens in one process.
#include "elrom/scene/shared_sweep.hpp"

#include <barrier>
#include <map>
#include <thread>

#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

// Each member has the spheres whose number leaves a remainder of its own, and all others as ghosts.
class Crew {
 public:
  explicit Crew(int n) : n_(n), meet_(n), values_(static_cast<std::size_t>(n)) {}

  class Member final : public Team {
   public:
    Member(Crew& crew, int rank, const std::vector<std::int64_t>& ids, std::size_t n_own)
        : crew_(crew), rank_(rank), ids_(ids), n_own_(n_own) {}
    void forward(std::span<double> values, std::size_t width) override {
      for (std::size_t i = 0; i < n_own_; ++i) {
        const auto row = values.subspan(i * width, width);
        crew_.shared_[static_cast<std::size_t>(ids_[i])].assign(row.begin(), row.end());
      }
      crew_.meet_.arrive_and_wait();
      for (std::size_t i = n_own_; i < ids_.size(); ++i)
        std::ranges::copy(crew_.shared_[static_cast<std::size_t>(ids_[i])],
                          values.begin() + static_cast<std::ptrdiff_t>(i * width));
      crew_.meet_.arrive_and_wait();
    }
    double least(double value) override {
      crew_.values_[static_cast<std::size_t>(rank_)] = value;
      crew_.meet_.arrive_and_wait();
      const double least = *std::ranges::min_element(crew_.values_);
      crew_.meet_.arrive_and_wait();
      return least;
    }

   private:
    Crew& crew_;
    int rank_;
    const std::vector<std::int64_t>& ids_;
    std::size_t n_own_;
  };

  // Runs a span. @return all spheres at its end in their order, with the sums of the tallies
  State run(const State& all, const Domain& domain, const MoverSettings& settings, const Span& span) {
    shared_.resize(all.particles.size());
    std::vector<State> parts(static_cast<std::size_t>(n_));
    std::vector<std::thread> threads;
    for (int rank = 0; rank < n_; ++rank)
      threads.emplace_back([&, rank] {
        run_member(rank, all, domain, settings, span, parts[static_cast<std::size_t>(rank)]);
      });
    for (auto& thread : threads) thread.join();
    return merged(all, parts, span.time);
  }
  bool held = true;

 private:
  void run_member(int rank, const State& all, const Domain& domain, const MoverSettings& settings,
                  const Span& span, State& part) {
    part = all;
    part.particles = {};
    part.particles.rotates = all.particles.rotates,
    part.particles.remembers_hits = all.particles.remembers_hits;
    part.particles.remembers_walls = all.particles.remembers_walls;
    std::size_t n_own = 0;
    for (const bool own : {true, false})
      for (std::size_t i = 0; i < all.particles.size(); ++i) {
        if ((static_cast<int>(i) % n_ == rank) != own) continue;
        part.particles.add(all.particles.sphere(i));
        n_own += own ? 1 : 0;
      }
    Partners partners{{0}, {}};
    const auto n = static_cast<std::int32_t>(part.particles.size());
    for (std::int32_t i = 0; i < n; ++i) {
      for (std::int32_t j = 0; j < n; ++j)
        if (i != j && std::min(i, j) < static_cast<std::int32_t>(n_own)) partners.of.push_back(j);
      partners.begin.push_back(partners.of.size());
    }
    Member member(*this, rank, part.particles.id, n_own);
    SharedSweep sweep(domain, settings);
    if (!sweep.sweep(part, n_own, partners, span, member)) held = false;
    std::vector<std::uint8_t> keep(part.particles.size(), 0);
    std::fill_n(keep.begin(), n_own, std::uint8_t{1});
    part.particles.keep_only(keep);
  }
  static State merged(const State& all, const std::vector<State>& parts, double time) {
    State whole = all;
    whole.tally = {};
    for (const auto& part : parts) {
      whole.tally.collisions += part.tally.collisions, whole.tally.wall_hits += part.tally.wall_hits;
      for (std::size_t k = 0; k < part.particles.size(); ++k) {
        const auto i = static_cast<std::size_t>(part.particles.id[k]);
        set(whole.particles.velocity, i, get(part.particles.velocity, k));
        set(whole.particles.place, i, get(part.particles.place, k) + time * get(part.particles.velocity, k));
        if (whole.particles.rotates) set(whole.particles.spin, i, get(part.particles.spin, k));
      }
    }
    return whole;
  }

  int n_;
  std::barrier<> meet_;
  std::vector<double> values_;
  std::vector<std::vector<double>> shared_;
};

TEST(SceneSharedSweep, IsTheSweptCollisionsOfOneProcess) {
  const double edge = 0.01;  // 6 % of it spheres
  const Domain domain = test::periodic_cube(edge);
  const auto settings = test::hard_spheres(0.9);
  State native = test::cloud(120, edge, 1e-3, 1, 3);
  const State start = native;
  const double time = 3e-3;
  make_mover(domain, settings)->advance(native, time);

  const State shared = Crew(1).run(start, domain, settings, {.time = time, .step = time, .fastest = 20});

  EXPECT_GT(native.tally.collisions, 120);  // so that many collide more than once
  EXPECT_EQ(shared.tally.collisions, native.tally.collisions);
  for (std::size_t i = 0; i < start.particles.size(); ++i) {
    const Vec d = get(shared.particles.velocity, i) - get(native.particles.velocity, i);
    EXPECT_LT(std::sqrt(dot(d, d)), 1e-9) << i;
  }
}

TEST(SceneSharedSweep, GivesTheSameBitsInAnyNumberOfProcesses) {
  const double edge = 0.012;
  const Domain domain({test::box({}, {edge, edge, edge})});
  auto settings = test::hard_spheres(0.9, 1, 0.3);
  settings.walls.normal_restitution = 0.8;
  const State start = test::cloud(120, edge, 1e-3, 1, 3, true);
  const Span span{.time = 2e-3, .step = 2e-3, .fastest = 20};

  const State one = Crew(1).run(start, domain, settings, span);

  EXPECT_GT(one.tally.wall_hits, 5);
  for (const int n : {2, 3}) {
    const State several = Crew(n).run(start, domain, settings, span);
    EXPECT_EQ(several.tally.collisions, one.tally.collisions);
    EXPECT_EQ(several.tally.wall_hits, one.tally.wall_hits);
    test::expect_same_bits(several.particles, one.particles);
  }
}

TEST(SceneSharedSweep, SaysAtAllProcessesThatASphereBecameTooFast) {
  State state = test::empty_state();
  test::add(state, {0, 0, 0}, {1, 0, 0}, 2e-3);
  test::add(state, {0.003, 0, 0}, {}, 1e-3);  // is thrown ahead at 1.8 m/s
  const Domain domain;
  const Span span{.time = 0.01, .step = 0.01, .fastest = 1.5};
  Crew crew(2);

  (void)crew.run(state, domain, test::hard_spheres(1), span);

  EXPECT_FALSE(crew.held);
}

}  // namespace
}  // namespace elrom::scene
