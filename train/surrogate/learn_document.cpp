#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/surrogate/learn_trees.hpp"

namespace elrom::surrogate {
namespace {

using particle::Table;

constexpr std::size_t fewest_pairs = 20;

struct LearnedPart {
  std::optional<particle::DocumentPart> part;
  DocumentRange range;
};

Table scaled_table(const Table& rows, const math::Standardiser& scaler) {
  return (rows.rowwise() - scaler.mean().transpose().array()).rowwise() / scaler.scale().transpose().array();
}

void judge(const Table& before, const Table& after, LearnedPart& learned) {
  auto& range = learned.range;
  const Table error = (learned.part->evaluate(before) - after).abs();
  for (std::size_t k = 0; k < 6; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    range.mae[k] = error.col(column).mean();
    const Eigen::ArrayXd relative = error.col(column) / after.col(column).abs().max(1e-300);
    range.median_relative[k] = math::median({relative.begin(), relative.end()});
  }
}

LearnedPart learn_range(const particle::CollisionSet& set, const DocumentSettings& settings,
                        const TreeTrainer& trainer, const TreeContext& context) {
  if (set.size() < fewest_pairs)
    throw InputError(Problem{.what = "too few collisions to learn from",
                             .found = std::to_string(set.size()),
                             .expected = std::to_string(fewest_pairs) + " or more"});
  const Table before = particle::six_velocities(set.pairs.before);
  const Table after = particle::six_velocities(set.parting.after);
  LearnedPart learned;
  learned.range.n_test = particle::n_test_pairs(set.size(), settings.test);
  const auto n_test = static_cast<Eigen::Index>(learned.range.n_test), n_known = before.rows() - n_test;

  const Table known = before.topRows(n_known);
  const math::Standardiser scaler(MatrixD(known.matrix()));
  const auto trees =
      learn_trees(scaled_table(known, scaler), after.topRows(n_known), {}, settings.trees, trainer, context);
  learned.part = particle::DocumentPart{scaler, *trees.trees};
  learned.range.hyperparameters = trees.hyperparameters;
  std::ranges::copy(trees.rounds, learned.range.rounds.begin());
  learned.range.search_seconds = trees.search_seconds;
  learned.range.fit_seconds = trees.fit_seconds;
  judge(before.bottomRows(n_test), after.bottomRows(n_test), learned);
  return learned;
}

}  // namespace

LearnedDocument learn_document(const particle::CollisionSet& full, const particle::CollisionSet* low,
                               const DocumentSettings& settings, const TreeTrainer& trainer,
                               const TreeContext& context) {
  std::array<LearnedPart, 2> parts;
  base::parallel_for(
      low == nullptr ? 1 : 2, context.n_threads,
      [&](std::size_t i, int) {
        auto own = context;
        own.name += i == 0 ? ", all speeds" : ", slow pairs";
        own.seed = context.seed.derive(i);
        parts[i] = learn_range(i == 0 ? full : *low, settings, trainer, own);
      },
      context.stop);
  LearnedDocument learned{.model = {}, .full = parts[0].range, .low = {}};
  std::optional<particle::DocumentModel::Low> slow;
  if (low != nullptr) {
    slow = particle::DocumentModel::Low{low->protocol.speed.high, std::move(*parts[1].part)};
    learned.low = parts[1].range;
  }
  learned.model = std::make_shared<particle::DocumentModel>(std::move(*parts[0].part), std::move(slow));
  return learned;
}

}  // namespace elrom::surrogate
