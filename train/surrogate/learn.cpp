#include "elrom/surrogate/learn.hpp"

#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/version.hpp"
#include "elrom/particle/exact_model.hpp"
#include "elrom/particle/network_regressor.hpp"

namespace elrom::surrogate {
namespace {

using particle::FrameRecords;
using particle::SurrogateKind;
using particle::Table;

constexpr double validation_share = 0.25;

math::Standardiser scaler_of(const Table& rows) { return math::Standardiser(MatrixD(rows.matrix())); }

MatrixF scaled(const Table& rows, const math::Standardiser& scaler) {
  return scaler.apply(MatrixD(rows.matrix())).cast<float>();
}

std::shared_ptr<const particle::Regressor> learn_network(const FrameRecords& records,
                                                         const LearnSettings& settings,
                                                         const LearnTools& tools) {
  if (tools.networks == nullptr)
    throw NotBuiltError(Problem{.what = "networks need LibTorch, which this build left out",
                                .advice = "build with -DELROM_TORCH=ON, or take --regressor chebyshev"});
  const auto inputs = scaler_of(records.inputs), outputs = scaler_of(records.targets);
  const auto n_validation =
      static_cast<Eigen::Index>(validation_share * static_cast<double>(records.inputs.rows()));
  const auto n_train = records.inputs.rows() - n_validation;
  const MatrixF x = scaled(records.inputs, inputs), y = scaled(records.targets, outputs);
  networks::TrainingProblem problem;
  problem.train_inputs = x.topRows(n_train);
  problem.train_targets = y.topRows(n_train);
  problem.validation_inputs = x.bottomRows(n_validation);
  problem.validation_targets = y.bottomRows(n_validation);
  auto trained = tools.networks->train(problem, settings.network, settings.network_budget,
                                       tools.seed.derive("network"), nullptr, tools.stop);
  networks::tell_divergence(trained, "collisions", *tools.log);
  if (trained.diverged)
    throw NumericalError("the network of the collisions diverged; lower its learning rate");
  return std::make_shared<particle::NetworkRegressor>(inputs, outputs, std::move(trained.network));
}

TreeContext tree_context(const LearnTools& tools, const char* name) {
  return {.name = name,
          .seed = tools.seed.derive(name),
          .n_threads = tools.n_threads,
          .store = tools.store,
          .log = tools.log,
          .stop = tools.stop};
}

const TreeTrainer& tree_trainer(const LearnTools& tools) {
  static const auto missing = missing_tree_trainer();
  return tools.trees == nullptr ? *missing : *tools.trees;
}

std::shared_ptr<const particle::Regressor> learn_regressor(const FrameRecords& records,
                                                           const LearnSettings& settings,
                                                           const LearnTools& tools) {
  switch (settings.regressor) {
    case RegressorKind::chebyshev:
      return learn_chebyshev(records, settings.chebyshev);
    case RegressorKind::trees: {
      // Squares of the velocities' errors count, as for Chebyshev.
      const Eigen::ArrayXd weights = records.speed.square() / records.speed.square().mean();
      return learn_trees(records.inputs, records.targets, weights, settings.trees, tree_trainer(tools),
                         tree_context(tools, "frame"))
          .trees;
    }
    case RegressorKind::network:
      break;
  }
  return learn_network(records, settings, tools);
}

std::shared_ptr<const particle::CollisionModel> learn_frame(const particle::CollisionSet& set,
                                                            std::size_t n_train,
                                                            const LearnSettings& settings,
                                                            const LearnTools& tools) {
  if (set.speed_cap || set.protocol.approach_time)
    throw UsageError(
        Problem{.what = "a frame surrogate learns collisions that begin as the spheres touch",
                .found = set.speed_cap ? "a set with capped speeds" : "a set with an approach time",
                .advice = "make the set without --approach-time and --speed-cap"});
  const auto pairs = slice(set.pairs, 0, n_train);
  const bool with_spins = set.protocol.spin_speed > 0;
  const auto records =
      particle::frame_records(pairs, slice(set.parting.after, 0, n_train), set.law, with_spins);
  return std::make_shared<particle::FrameModel>(set.law, learn_regressor(records, settings, tools),
                                                records.inputs.col(1).maxCoeff());
}

}  // namespace

LearnedCollisions learn_collisions(const particle::CollisionSet& set, const particle::CollisionSet* low,
                                   const LearnSettings& settings, const LearnTools& tools) {
  const base::Stopwatch watch;
  const auto n_test = particle::n_test_pairs(set.size(), settings.test);
  const auto n_train = set.size() - n_test;
  LearnedCollisions learned;
  switch (settings.surrogate) {
    case SurrogateKind::document: {
      const DocumentSettings document{.test = settings.test, .trees = settings.trees};
      learned.document =
          learn_document(set, low, document, tree_trainer(tools), tree_context(tools, "document"));
      learned.bundle.model = learned.document->model;
      break;
    }
    case SurrogateKind::frame:
      learned.bundle.model = learn_frame(set, n_train, settings, tools);
      break;
    case SurrogateKind::exact:
      learned.bundle.model = std::make_shared<particle::ExactModel>(set.law);
      break;
  }
  learned.seconds = watch.seconds();
  learned.errors = particle::errors_of(*learned.bundle.model, set, n_train, n_test);
  learned.bundle.protocol = set.protocol;
  learned.bundle.law = set.law;
  learned.bundle.accuracy_json = to_json(learned.errors);
  learned.bundle.provenance = {{"program", program_version()},
                               {"pairs", std::to_string(set.size())},
                               {"surrogate", std::string(particle::surrogate_names.name(settings.surrogate))},
                               {"training_s", std::to_string(learned.seconds)}};
  if (settings.surrogate == SurrogateKind::frame)
    learned.bundle.provenance["regressor"] = regressor_names.name(settings.regressor);
  return learned;
}

}  // namespace elrom::surrogate
