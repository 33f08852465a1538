// bench-collisions: two-particle DEM and what learns from it. Seconds of 60,000 pairs, errors of the
// surrogates, momentum and energy of random calls, calls a second; and the source's surrogate by its
// protocol, with and without what it added.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/random.hpp"
#include "elrom/particle/balance.hpp"
#include "elrom/particle/exact_model.hpp"
#include "elrom/surrogate/learn.hpp"
#include "support/benchmark.hpp"
#if ELROM_HAS_XGBOOST
#include "elrom/xgboost/trainer.hpp"
#endif

namespace {

using namespace elrom;
using namespace elrom::particle;
using benchmark::Stopwatch;
using Json = nlohmann::ordered_json;

constexpr double d_small = 315e-6, d_large = 475e-6;  // the source's two, m

/// A protocol and a law that belong together.
struct Kind {
  std::string name;
  Protocol protocol;
  ContactLaw law;
};

// The stiffness at which the fastest central pair overlaps by 1 % of its diameter.
ContactLaw linear(double friction, double diameter = d_small) {
  constexpr double overlap = 0.01;
  const Ball ball{diameter, 1000};
  return {.friction = friction, .stiffness = stiffness_for_overlap(overlap, 40, ball, ball)};
}

std::vector<Kind> kinds() {
  const ContactLaw hertz{.kind = LawKind::hertz, .friction = 0.3};
  const Protocol document{.kind = ProtocolKind::document}, general;
  Protocol two_sizes, spinning;
  two_sizes.diameter_2 = {d_large, d_large};
  spinning.spin_speed = 10;
  return {{"document, linear", document, linear(0)},
          {"general, linear", general, linear(0)},
          {"general, linear, mu 0.3", general, linear(0.3)},
          {"general, hertz, mu 0.3, 315 against 475 um", two_sizes, hertz},
          {"general, hertz, mu 0.3, spins", spinning, hertz}};
}

CollisionSet collisions(const Kind& kind, std::size_t n, int threads, std::uint64_t seed = 1,
                        std::optional<double> cap = {}) {
  return make_collisions(kind.protocol, kind.law, seed, 0, n, {.n_threads = threads}, cap);
}

double seconds_of(const Kind& kind, std::size_t n, int threads) {
  double best = INFINITY;
  for (int run = 0; run < 5; ++run) {
    const Stopwatch watch;
    (void)collisions(kind, n, threads);
    best = std::min(best, watch.seconds());
  }
  return best;
}

#if ELROM_HAS_XGBOOST
std::shared_ptr<const surrogate::TreeTrainer> tree_trainer() { return xgboost::make_tree_trainer(); }
#else
std::shared_ptr<const surrogate::TreeTrainer> tree_trainer() { return nullptr; }
#endif

surrogate::LearnedCollisions learn(const CollisionSet& set, SurrogateKind kind, int threads,
                                   surrogate::RegressorKind regressor = surrogate::RegressorKind::chebyshev,
                                   int trials = 0) {
  surrogate::LearnSettings settings{.surrogate = kind, .regressor = regressor};
  settings.trees.trials = trials;
  return learn_collisions(set, nullptr, settings, {.trees = tree_trainer(), .n_threads = threads});
}

Json json_of(const CollisionErrors& errors) { return Json::parse(to_json(errors)); }

/// Pairs of anything: sizes 10 um to 5 mm, densities 1 to 10,000
/// kg/m3, 1e-6 to 1e3 m/s, spins, angles up to grazing.
Pairs random_pairs(std::size_t n, bool with_spins, base::Random& random) {
  const auto power = [&](double low, double high) { return low * std::pow(high / low, random.uniform()); };
  const auto direction = [&] {
    const double z = random.uniform(-1, 1), phi = random.uniform(0, 6.283185307179586);
    return Eigen::Array3d(std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z);
  };
  Pairs pairs(n);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(n); ++i) {
    pairs.diameter_1[i] = power(10e-6, 5e-3), pairs.diameter_2[i] = power(10e-6, 5e-3);
    pairs.density_1[i] = power(1, 1e4), pairs.density_2[i] = power(1, 1e4);
    const double speed = power(1e-6, 1e3);
    pairs.before.velocity_1.row(i) = speed * direction();
    pairs.before.velocity_2.row(i) = random.uniform() * speed * direction();
    const Eigen::Vector3d towards =
        (pairs.before.velocity_1.row(i) - pairs.before.velocity_2.row(i)).matrix().transpose().normalized();
    const Eigen::Vector3d across = towards.cross(direction().matrix()).normalized();
    // A tenth of the pairs within 1e-12 to 1e-2 of grazing.
    const double cosine = random.uniform() < 0.1 ? power(1e-12, 1e-2) : random.uniform();
    pairs.normal.row(i) =
        (cosine * towards + std::sqrt(1 - cosine * cosine) * across).normalized().transpose().array();
    if (!with_spins) continue;
    pairs.before.spin_1.row(i) = speed / pairs.diameter_1[i] * power(1e-3, 10) * direction();
    pairs.before.spin_2.row(i) = speed / pairs.diameter_2[i] * power(1e-3, 10) * direction();
  }
  return pairs;
}

struct Worst {
  double momentum = 0, gain = 0;
  std::size_t n = 0;
};

void judge(const CollisionModel& model, bool with_spins, std::size_t n_calls, Worst& worst) {
  constexpr std::size_t block = 50'000;
  base::Random random(base::Seed(7).derive(model.text() + (with_spins ? ", spins" : "")));
  for (std::size_t done = 0; done < n_calls; done += block) {
    const auto pairs = random_pairs(block, with_spins, random);
    const auto after = motion_after(model, pairs);
    const double momentum = momentum_errors(pairs, after).maxCoeff<Eigen::PropagateNaN>(),
                 gain = energy_changes(pairs, after).maxCoeff<Eigen::PropagateNaN>();
    check(std::isfinite(momentum) && std::isfinite(gain), "a model gives numbers");
    worst.momentum = std::max(worst.momentum, momentum);
    worst.gain = std::max(worst.gain, gain);
    worst.n += block;
  }
}

/// The approach time at which this share of the pairs starts overlapped.
double approach_time(Protocol protocol, double share, std::size_t n) {
  protocol.approach_time.reset();
  const auto pairs = draw_pairs(protocol, 1, 0, n);
  const Scalars speeds = lengths(pairs.before.velocity_1 - pairs.before.velocity_2);
  std::vector<double> times;  // that the spheres need for the sum of their radii
  for (Eigen::Index i = 0; i < speeds.size(); ++i)
    times.push_back(0.5 * (pairs.diameter_1[i] + pairs.diameter_2[i]) / speeds[i]);
  const auto place = times.end() - 1 - static_cast<std::ptrdiff_t>(share * static_cast<double>(n));
  std::nth_element(times.begin(), place, times.end());
  return *place;
}

double overlapped_share(const CollisionSet& set) { return (set.pairs.overlap > 0).cast<double>().mean(); }

struct Variant {
  const char* name;
  bool overlapped;
  std::optional<double> cap;
};

Json document_errors(Kind kind, const Variant& variant, double approach, std::size_t n,
                     const benchmark::Arguments& arguments) {
  if (variant.overlapped) kind.protocol.approach_time = approach;
  auto slow = kind;
  slow.protocol.speed = {0, 2};
  const auto set = collisions(kind, n, arguments.threads, 1, variant.cap),
             low = collisions(slow, n, arguments.threads, 2, variant.cap);
  surrogate::DocumentSettings settings;
  settings.trees.trials = arguments.small ? 0 : 4;
  const auto learned = learn_document(set, &low, settings, *tree_trainer(), {.n_threads = arguments.threads});
  const auto by_component = [](const surrogate::DocumentRange& range) {
    Json mae = Json::array();
    for (std::size_t k = 0; k < 3; ++k) mae.push_back(0.5 * (range.mae[k] + range.mae[k + 3]));
    return mae;
  };
  return {{"variant", variant.name},
          {"mae", by_component(learned.full)},
          {"mae_low", by_component(*learned.low)},
          {"overlapped", overlapped_share(set)},
          {"overlapped_low", overlapped_share(low)},
          {"n_rounds", learned.full.rounds[0]}};
}

/// The source's protocol; what it added one by one; the same trees on any impact point.
Json reproduction(std::size_t n, const benchmark::Arguments& arguments) {
  // One time for both diameters, from the share that the source names at the smaller one.
  const Protocol small{.kind = ProtocolKind::document};
  const double approach = approach_time(small, 0.028, n);
  Json result{{"approach_time_s", approach}};
  const std::vector<Variant> variants{{"as the source: overlapped, capped at 100 m/s", true, 100},
                                      {"overlapped, no cap", true, std::nullopt},
                                      {"starts as it touches", false, std::nullopt}};
  constexpr std::array printed{std::array{0.5877, 0.5802, 0.5531}, std::array{0.7078, 0.7276, 0.6078}};
  for (std::size_t i = 0; i < 2; ++i) {
    const double d = i == 0 ? d_small : d_large;
    Json node{{"diameter_m", d}, {"printed", printed[i]}};
    auto protocol = small;
    protocol.diameter_1 = protocol.diameter_2 = {d, d};
    for (const auto& variant : variants)
      node["variants"].push_back(
          document_errors({"", protocol, linear(0, d)}, variant, approach, n, arguments));
    for (const double stiffness : {1000.0, 1500.0}) {  // N/m: the softness that the source's figures ask for
      auto soft =
          document_errors({"", protocol, {.stiffness = stiffness}}, variants[0], approach, n, arguments);
      soft["stiffness_n_per_m"] = stiffness;
      node["soft"].push_back(soft);
    }
    result["diameters"].push_back(node);
  }
  result["any_impact_point"] = document_errors({"", {}, linear(0)}, variants[2], approach, n, arguments);
  return result;
}

Json measure(const benchmark::Arguments& arguments) {
  constexpr std::size_t n_timed = 60'000;
  const std::size_t n = arguments.small ? 12'000 : n_timed, n_calls = arguments.small ? 500'000 : 10'000'000;
  const bool trees = tree_trainer() != nullptr;
  Json json{{"pair_seconds", 0.0}, {"mae_document", nullptr}, {"mae_frame", 0.0}};
  Json calls;
  Worst worst;
  for (const auto& kind : kinds()) {
    json["seconds_of_60000_pairs"][kind.name] = seconds_of(kind, n_timed, arguments.threads);
    const auto set = collisions(kind, n, arguments.threads);
    const auto test = slice(set.pairs, n - n_test_pairs(n), n_test_pairs(n));
    const auto frame = learn(set, SurrogateKind::frame, arguments.threads);
    const bool spins = kind.protocol.spin_speed > 0;
    json["frame"][kind.name] = json_of(frame.errors);
    json["frame"][kind.name]["training_seconds"] = frame.seconds;
    json["exact"][kind.name] =
        json_of(errors_of(ExactModel(kind.law), set, n - n_test_pairs(n), n_test_pairs(n)));
    if (kind.protocol.kind == ProtocolKind::general) {
      judge(*frame.bundle.model, spins, n_calls / 4, worst);
      json["mae_frame"] = std::max(json["mae_frame"].get<double>(), frame.errors.mae_velocity);
    }
    if (kind.name == "general, linear, mu 0.3" || spins)
      calls[spins ? "frame, chebyshev, spins" : "frame, chebyshev"] =
          1 / seconds_a_call(*frame.bundle.model, test, n_timed * 20);
    if (kind.name != "general, linear, mu 0.3") continue;
    const ExactModel exact(kind.law);
    judge(exact, true, n_calls / 10, worst);
    calls["exact"] = 1 / seconds_a_call(exact, test, n_timed * 20);
    if (!trees) continue;
    const auto grown = learn(set, SurrogateKind::frame, arguments.threads, surrogate::RegressorKind::trees);
    json["frame_trees"] = json_of(grown.errors);
    calls["frame, trees"] = 1 / seconds_a_call(*grown.bundle.model, test, n_timed);
    judge(*grown.bundle.model, false, n_calls / 100, worst);
  }
  json["pair_seconds"] = json["seconds_of_60000_pairs"]["document, linear"];
  json["momentum_error"] = worst.momentum;
  json["energy_gain"] = worst.gain;
  json["random_calls"] = worst.n;
  if (trees) {
    const auto set = collisions(kinds().front(), n, arguments.threads);
    const auto document = learn(set, SurrogateKind::document, arguments.threads,
                                surrogate::RegressorKind::trees, arguments.small ? 0 : 4);
    json["mae_document"] = document.errors.mae;
    json["document"] = json_of(document.errors);
    json["document"]["training_seconds"] = document.seconds;
    calls["document, trees"] = 1 / seconds_a_call(*document.bundle.model, set.pairs, n_timed);
    json["reproduction"] = reproduction(n, arguments);
  }
  json["calls_per_second"] = calls;
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main(
      "bench-collisions", "Two-particle DEM, surrogates of collisions, the source's beside them.", "not used",
      argc, argv, measure);
}
