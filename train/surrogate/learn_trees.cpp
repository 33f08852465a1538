#include "elrom/surrogate/learn_trees.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/stopwatch.hpp"

namespace elrom::surrogate {
namespace {

using particle::Table;
using Rows = std::vector<Eigen::Index>;

constexpr std::size_t fewest_records = 10;

Rows shuffled(std::size_t n, base::Seed seed) {
  Rows rows(n);
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  base::Random random(seed);
  random.shuffle(rows);
  return rows;
}

// At least one and never all.
std::size_t share(std::size_t n, double fraction) {
  const auto wanted = static_cast<std::size_t>(std::lround(fraction * static_cast<double>(n)));
  return std::clamp<std::size_t>(wanted, 1, n - 1);
}

// What search() reads, of the settings' members by these names.
struct Plan {
  std::string algorithm;
  int trials;
  bool prune;
  int confirm, confirm_seeds, max_epochs;
};

networks::SearchSpaceOf<TreeHyperparameters> space_of(const TreeSettings& settings) {
  return {settings.fixed,
          {{"n_estimators", networks::size_bins(settings.n_estimators, std::sqrt(2.0))},
           {"max_depth", networks::whole_bins(settings.max_depth)},
           {"learning_rate", networks::log_bins(settings.learning_rate, 16)},
           {"colsample_bytree", networks::even_bins(settings.colsample_bytree, 6)},
           {"reg_alpha", networks::log_bins(settings.reg_alpha, 3)}}};
}

class Learning {
 public:
  Learning(const Table& inputs, const Table& targets, const Eigen::ArrayXd& weights,
           const TreeSettings& settings, const TreeTrainer& trainer, const TreeContext& context)
      : inputs_(inputs),
        targets_(targets),
        weights_(weights),
        settings_(settings),
        trainer_(trainer),
        context_(context) {
    const auto n = static_cast<std::size_t>(inputs.rows());
    check(targets.rows() == inputs.rows() && targets.cols() > 0,
          "trees: a row of targets for each of inputs");
    check(settings.searched_output < static_cast<std::size_t>(targets.cols()), "trees: the searched output");
    if (n < fewest_records)
      throw InputError(Problem{.what = "too few records to learn trees from",
                               .found = std::to_string(n),
                               .expected = std::to_string(fewest_records) + " or more"});
    const auto rows = shuffled(n, context.seed.derive("validation"));
    const auto n_validation = static_cast<std::ptrdiff_t>(share(n, settings.validation));
    validation_.assign(rows.begin(), rows.begin() + n_validation);
    train_.assign(rows.begin() + n_validation, rows.end());
  }

  LearnedTrees run() {
    LearnedTrees learned{.hyperparameters = settings_.fixed};
    const base::Stopwatch search_watch;
    if (settings_.trials > 0) search(learned);
    learned.search_seconds = search_watch.seconds();
    const base::Stopwatch fit_watch;
    fit(learned);
    learned.fit_seconds = fit_watch.seconds();
    return learned;
  }

 private:
  [[nodiscard]] TreeRecords records(const Rows& rows, Eigen::Index output) const {
    return {inputs_(rows, Eigen::all), targets_(rows, output),
            weights_.size() == 0 ? Eigen::ArrayXd() : Eigen::ArrayXd(weights_(rows))};
  }

  // The first of the shuffled records are a sample of them.
  [[nodiscard]] TreeProblem sample(Eigen::Index output) const {
    const auto n = train_.size() + validation_.size();
    const double kept = std::min(1.0, static_cast<double>(settings_.search_records) / static_cast<double>(n));
    const auto some = [&](const Rows& rows) {
      const auto count =
          std::max<std::size_t>(1, static_cast<std::size_t>(kept * static_cast<double>(rows.size())));
      return Rows(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count));
    };
    return {records(some(train_), output), records(some(validation_), output)};
  }

  void search(LearnedTrees& learned) const {
    const auto problem = sample(static_cast<Eigen::Index>(settings_.searched_output));
    const TreeBudget budget{.patience = settings_.patience, .keep_trees = false};
    const Plan plan{.algorithm = settings_.algorithm,
                    .trials = settings_.trials,
                    .prune = settings_.prune,
                    .confirm = 0,
                    .confirm_seeds = 0,
                    .max_epochs = static_cast<int>(settings_.n_estimators.back())};
    const auto digest = base::digest_of_members(problem, settings_, context_.seed, trainer_.name());
    const auto found = networks::search(
        [&](const TreeHyperparameters& h, base::Seed seed, networks::TrainingMonitor* monitor) {
          return trainer_.train(problem, h, budget, seed, monitor, context_.stop);
        },
        plan, space_of(settings_),
        {.name = context_.name,
         .digest = digest,
         .seed = context_.seed.derive("search"),
         .store = context_.store,
         .log = context_.log,
         .stop = context_.stop});
    learned.hyperparameters = found.best;
    learned.n_trials = found.trials.size();
    learned.n_replayed = found.n_replayed;
  }

  void fit(LearnedTrees& learned) const {
    auto final = learned.hyperparameters;
    if (settings_.trials > 0)
      final.n_estimators = static_cast<int>(std::lround(final.n_estimators * settings_.final_rounds));
    const TreeBudget budget{.patience = settings_.patience};
    std::vector<GrownTrees> grown(static_cast<std::size_t>(targets_.cols()));
    std::atomic<std::int64_t> done = 0;
    const auto tell = [&](std::int64_t n) {
      context_.log->progress(
          {"grow " + context_.name, n, static_cast<std::int64_t>(grown.size()), "outputs", {}});
    };
    tell(0);
    base::parallel_for(
        grown.size(), context_.n_threads,
        [&](std::size_t k, int) {
          const auto output = static_cast<Eigen::Index>(k);
          grown[k] = trainer_.train({records(train_, output), records(validation_, output)}, final, budget,
                                    context_.seed.derive("fit").derive(k), nullptr, context_.stop);
          tell(++done);
        },
        context_.stop);
    join(grown, learned);
  }

  void join(const std::vector<GrownTrees>& grown, LearnedTrees& learned) const {
    std::vector<particle::TreeNode> nodes;
    std::vector<particle::TreeGroup> groups;
    for (const auto& output : grown) {
      if (output.diverged)
        throw NumericalError(Problem{.what = "growing trees diverged", .where = context_.name});
      const auto first = static_cast<std::int32_t>(nodes.size());
      for (auto node : output.nodes) {
        if (node.feature >= 0) node.left += first;
        nodes.push_back(node);
      }
      groups.push_back(output.group);
      for (auto& root : groups.back().roots) root += first;
      learned.validation_mse.push_back(output.validation_mse);
      learned.rounds.push_back(static_cast<int>(output.group.roots.size()));
    }
    learned.trees = std::make_unique<particle::Trees>(static_cast<std::size_t>(inputs_.cols()),
                                                      std::move(nodes), std::move(groups));
  }

  const Table& inputs_;
  const Table& targets_;
  const Eigen::ArrayXd& weights_;
  const TreeSettings& settings_;
  const TreeTrainer& trainer_;
  const TreeContext& context_;
  Rows train_, validation_;
};

}  // namespace

LearnedTrees learn_trees(const Table& inputs, const Table& targets, const Eigen::ArrayXd& weights,
                         const TreeSettings& settings, const TreeTrainer& trainer,
                         const TreeContext& context) {
  return Learning(inputs, targets, weights, settings, trainer, context).run();
}

}  // namespace elrom::surrogate
