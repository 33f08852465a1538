#include <algorithm>
#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/surrogate/learn_trees.hpp"

namespace elrom::surrogate {
namespace {

using particle::Table;

struct LearnedPart {
  std::optional<particle::DocumentPart> part;
  DocumentRange range;
};

math::Standardiser standardiser_of(const Table& rows) { return math::Standardiser(MatrixD(rows.matrix())); }

Table scaled(const Table& rows, const math::Standardiser& scaler) {
  return (rows.rowwise() - scaler.mean().transpose().array()).rowwise() / scaler.scale().transpose().array();
}

void judge(const Table& before, const Table& after, LearnedPart& learned) {
  auto& range = learned.range;
  const Table error =
      (learned.part->evaluate(before(range.test, Eigen::all)) - after(range.test, Eigen::all)).abs();
  const Table size = after(range.test, Eigen::all).abs();
  for (std::size_t k = 0; k < 6; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    range.mae[k] = error.col(column).mean();
    const Eigen::ArrayXd relative = error.col(column) / size.col(column).max(1e-300);
    range.median_relative[k] = math::median({relative.begin(), relative.end()});
  }
}

LearnedPart learn_range(const particle::CollisionSet& set, const DocumentSettings& settings,
                        const TreeTrainer& trainer, const TreeContext& context) {
  const Table before = particle::six_velocities(set.pairs.before);
  const Table after = particle::six_velocities(set.parting.after);
  if (set.size() < 20)
    throw InputError(Problem{.what = "too few collisions to learn from",
                             .found = std::to_string(set.size()),
                             .expected = "20 or more"});
  const auto n_test = particle::n_test_pairs(set.size(), settings.test);
  std::vector<std::size_t> rows(set.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  LearnedPart learned;
  learned.range.test.assign(rows.end() - static_cast<std::ptrdiff_t>(n_test), rows.end());
  rows.resize(rows.size() - n_test);

  const Table known = before(rows, Eigen::all);
  const auto scaler = standardiser_of(known);
  const auto trees =
      learn_trees(scaled(known, scaler), after(rows, Eigen::all), {}, settings.trees, trainer, context);
  learned.part = particle::DocumentPart{scaler, *trees.trees};
  learned.range.hyperparameters = trees.hyperparameters;
  std::ranges::copy(trees.rounds, learned.range.rounds.begin());
  learned.range.search_seconds = trees.search_seconds;
  learned.range.fit_seconds = trees.fit_seconds;
  judge(before, after, learned);
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
