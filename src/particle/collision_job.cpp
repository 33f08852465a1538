#include "elrom/particle/collision_job.hpp"

#include <cmath>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/stage_cache.hpp"

namespace elrom::particle {
namespace {

namespace fs = std::filesystem;

/// Small enough to lose little and to show progress, large enough to feed every thread of the solver.
constexpr std::size_t pairs_a_block = 8192;

struct BlockContext {
  int n_threads;
  std::stop_token stop;
  double* seconds;
};

io::Tensor tensor(const Components& values) { return io::Tensor::copy(MatrixD(values.matrix())); }
io::Tensor tensor(const Scalars& values) {
  const auto n = static_cast<std::size_t>(values.size());
  return io::Tensor::copy(std::span<const double>(values.data(), n), {n});
}

/// What came out of one block. Pairs are not kept: they are drawn again in no time.
struct CollisionBlock {
  static constexpr const char* stage = "collisions";
  static constexpr int version = 1;
  Protocol protocol;
  ContactLaw law;
  std::uint64_t seed;
  std::optional<double> speed_cap;
  std::size_t first, count;
  int steps_per_contact, most_steps;

  [[nodiscard]] io::TensorFile compute(const BlockContext& context) const {
    const base::Stopwatch watch;
    const PairSolverOptions options{steps_per_contact, most_steps, context.n_threads};
    const auto parting =
        make_collisions(protocol, law, seed, first, count, options, speed_cap, context.stop).parting;
    *context.seconds += watch.seconds();
    io::TensorFile file;
    file.set("after/velocity_1", tensor(parting.after.velocity_1));
    file.set("after/velocity_2", tensor(parting.after.velocity_2));
    file.set("after/spin_1", tensor(parting.after.spin_1));
    file.set("after/spin_2", tensor(parting.after.spin_2));
    file.set("overlap", tensor(parting.overlap));
    file.set("duration", tensor(parting.duration));
    file.set_text("stayed", std::to_string(parting.n_stayed));
    file.set_text("steps", base::number(parting.pair_steps));
    return file;
  }
};

void fetch(const io::TensorFile& file, const std::string& name, std::size_t first, std::size_t count,
           Components& all) {
  all.middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count)) =
      file.tensor(name, std::array<std::size_t, 2>{count, 3}).matrix64().array();
}

void fetch(const io::TensorFile& file, const std::string& name, std::size_t first, std::size_t count,
           Scalars& all) {
  const auto values = file.tensor(name, std::array{count}).f64();
  std::copy(values.begin(), values.end(), all.data() + first);
}

double number_in(const io::TensorFile& file, const std::string& key) {
  const auto value = base::to_double(file.text(key));
  if (!value)
    throw InputError({.what = "no number as '" + key + "'", .where = file.where(), .advice = "remove it"});
  return *value;
}

void add(Parting& all, const io::TensorFile& block, std::size_t first, std::size_t count) {
  fetch(block, "after/velocity_1", first, count, all.after.velocity_1);
  fetch(block, "after/velocity_2", first, count, all.after.velocity_2);
  fetch(block, "after/spin_1", first, count, all.after.spin_1);
  fetch(block, "after/spin_2", first, count, all.after.spin_2);
  fetch(block, "overlap", first, count, all.overlap);
  fetch(block, "duration", first, count, all.duration);
  all.n_stayed += static_cast<std::size_t>(number_in(block, "stayed"));
  all.pair_steps += number_in(block, "steps");
}

void expect_masses(const Range& diameter, double density) {
  for (const double size : {diameter.low, diameter.high}) {
    const double mass = sphere_mass(size, density);
    if (!std::isnormal(mass))
      throw UsageError({.what = "a sphere of no finite mass",
                        .found = base::number(size) + " m of " + base::number(density) + " kg/m3"});
  }
}

fs::path blocks_of(const fs::path& path) {
  return path.parent_path() / ("." + path.filename().string() + ".blocks");
}

}  // namespace

void CollisionJob::check() const {
  constexpr std::size_t most_pairs = 100'000'000;
  if (n_pairs < 1 || n_pairs > most_pairs)
    throw UsageError({.what = "number of pairs",
                      .found = std::to_string(n_pairs),
                      .expected = "1 to " + std::to_string(most_pairs)});
  protocol.check();
  expect_masses(protocol.diameter_1, protocol.density_1);
  expect_masses(protocol.diameter_2, protocol.density_2);
  law.check();
  if (speed_cap && !(*speed_cap > 0 && std::isfinite(*speed_cap)))
    throw UsageError(
        {.what = "wrong speed cap, in m/s", .found = base::number(*speed_cap), .expected = "more than 0"});
}

CollisionRun make_collision_file(const fs::path& path, const CollisionJob& job,
                                 const std::map<std::string, std::string>& provenance, Log& log,
                                 const std::stop_token& stop) {
  job.check();
  const base::FileLock lock(base::lock_beside(path));
  base::remove_remains(path);
  CollisionRun run;
  auto& set = run.set;
  set = {.protocol = job.protocol,
         .law = job.law,
         .seed = job.seed,
         .speed_cap = job.speed_cap,
         .pairs = draw_pairs(job.protocol, job.seed, 0, job.n_pairs),
         .provenance = provenance};
  set.parting = {.after = Motion(job.n_pairs), .overlap = set.pairs.overlap, .duration = set.pairs.overlap};
  const io::StageCache blocks(blocks_of(path), log);
  for (std::size_t first = 0; first < job.n_pairs; first += pairs_a_block) {
    const auto count = std::min(pairs_a_block, job.n_pairs - first);
    const CollisionBlock block{
        job.protocol,          job.law, job.seed, job.speed_cap, first, count, job.options.steps_per_contact,
        job.options.most_steps};
    try {
      const double before = run.seconds;
      const auto file = blocks.get("from " + std::to_string(first), block,
                                   BlockContext{job.options.n_threads, stop, &run.seconds});
      add(set.parting, file, first, count);
      if (run.seconds == before) run.n_reused += count;
    } catch (const Interrupted&) {
      throw Interrupted("stopped on request; the same command goes on from here");
    }
    log.progress({.task = "collide",
                  .done = static_cast<std::int64_t>(first + count),
                  .total = static_cast<std::int64_t>(job.n_pairs),
                  .unit = "pairs"});
  }
  write_collisions(path, set);
  std::error_code left;  // what cannot be removed does no harm
  fs::remove_all(blocks_of(path), left);
  return run;
}

}  // namespace elrom::particle
