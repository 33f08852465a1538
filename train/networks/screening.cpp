#include "elrom/networks/screening.hpp"

#include <atomic>
#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "lane_network.hpp"

namespace elrom::networks {
namespace {

// Groups in a crew: enough that compaction keeps the lanes full, few enough that every thread finds work to
// the end.
constexpr std::size_t groups_in_crew = 14;

struct Unit {
  std::size_t i_build;
  std::vector<std::uint32_t> columns;
};

std::vector<Unit> make_units(std::size_t n_builds, std::size_t n_columns) {
  const std::size_t n_groups = (n_columns + n_lanes - 1) / n_lanes;
  const std::size_t n_crews = (n_groups + groups_in_crew - 1) / groups_in_crew;
  std::vector<Unit> units;
  for (std::size_t b = 0; b < n_builds; ++b) {
    for (std::size_t c = 0; c < n_crews; ++c) {
      const auto first = n_groups * c / n_crews * n_lanes;
      const auto last = std::min(n_groups * (c + 1) / n_crews * n_lanes, n_columns);
      std::vector<std::uint32_t> columns(last - first);
      std::iota(columns.begin(), columns.end(), static_cast<std::uint32_t>(first));
      units.push_back({b, std::move(columns)});
    }
  }
  return units;
}

double bounded(double error) {
  return error < largest_error ? error : largest_error;
}  // NaN becomes the largest

std::vector<double> records_a_plane(const ScreeningData& data) {
  std::vector<double> count(data.n_planes, 0.0);
  for (const auto row : data.judging_rows()) count[static_cast<std::size_t>(data.plane[row])] += 1;
  return count;
}

void check_data(const ScreeningData& data) {
  const auto n = static_cast<std::size_t>(data.inputs.rows());
  check(static_cast<std::size_t>(data.targets.rows()) == n && data.plane.size() == n &&
            data.part.size() == n && data.case_of.size() == n,
        "screening: every record has inputs, targets, plane, case and part");
  if (data.rows(Part::train).empty() || data.rows(Part::validation).empty()) {
    throw InputError({.what = "too few cases to screen with networks",
                      .expected = "cases to train with and others to stop by",
                      .advice = "give more cases, or ask for a method without networks"});
  }
}

// Outcomes of all units, in the order of the units, put into tables of errors.
ScreeningResult collect(const ScreeningData& data, int builds, const std::vector<Unit>& units,
                        const std::vector<std::vector<ColumnOutcome>>& outcomes) {
  const auto n_columns = data.targets.cols();
  const auto n_builds = static_cast<Eigen::Index>(builds);
  const auto count = records_a_plane(data);
  ScreeningResult result;
  result.error = MatrixD::Zero(static_cast<Eigen::Index>(data.n_planes), n_columns);
  result.build_error = MatrixD::Zero(n_builds, n_columns);
  double epochs = 0;
  for (std::size_t i = 0; i < units.size(); ++i) {
    for (std::size_t m = 0; m < units[i].columns.size(); ++m) {
      const auto& outcome = outcomes[i][m];
      const auto column = static_cast<Eigen::Index>(units[i].columns[m]);
      const double whole = bounded(outcome.error);
      result.build_error(static_cast<Eigen::Index>(units[i].i_build), column) = whole;
      for (std::size_t p = 0; p < count.size(); ++p) {
        const double error = count[p] > 0 ? bounded(outcome.plane_error[p] / count[p]) : whole;
        result.error(static_cast<Eigen::Index>(p), column) += error / static_cast<double>(n_builds);
      }
      epochs += outcome.epochs;
    }
  }
  result.mean_epochs = epochs / static_cast<double>(n_columns * n_builds);
  return result;
}

}  // namespace

std::vector<std::uint32_t> ScreeningData::rows(Part wanted) const {
  std::vector<std::uint32_t> rows;
  for (std::size_t r = 0; r < part.size(); ++r)
    if (part[r] == wanted) rows.push_back(static_cast<std::uint32_t>(r));
  return rows;
}

std::vector<std::uint32_t> ScreeningData::judging_rows() const {
  auto test = rows(Part::test);
  return test.empty() ? rows(Part::validation) : test;
}

std::vector<double> ScreeningResult::column_error() const {
  const Eigen::RowVectorXd mean = build_error.colwise().mean();
  return {mean.data(), mean.data() + mean.size()};
}

ColumnNetwork initial_network(base::Seed seed, std::size_t i_build, std::size_t i_column,
                              std::size_t n_inputs, std::size_t n_units) {
  base::Random random(seed.derive("weights").derive(i_build).derive(i_column));
  const auto draw = [&](std::size_t fan_in) {
    const double limit = 1 / std::sqrt(static_cast<double>(fan_in));
    return static_cast<float>(random.uniform(-limit, limit));
  };
  ColumnNetwork network{MatrixF(static_cast<Eigen::Index>(n_units), static_cast<Eigen::Index>(n_inputs + 1)),
                        std::vector<float>(n_units + 1)};
  for (auto& weight : network.hidden.reshaped<Eigen::RowMajor>()) weight = draw(n_inputs);
  for (auto& weight : network.output) weight = draw(n_units);
  return network;
}

std::vector<std::uint32_t> epoch_order(base::Seed seed, std::size_t i_build, std::size_t i_epoch,
                                       std::size_t n_train, int most_records) {
  const auto part = epoch_part(n_train, most_records, i_epoch);
  std::vector<std::uint32_t> order(n_train);
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  base::Random(seed.derive("order").derive(i_build).derive(part.sweep)).shuffle(order);
  const auto first = order.begin() + static_cast<std::ptrdiff_t>(part.first);
  return {first, first + static_cast<std::ptrdiff_t>(part.size)};
}

ScreeningResult screen_networks(const ScreeningData& data, const ScreenSettings& settings,
                                const ScreeningContext& context) {
  check_data(data);
  const auto train_crew =
      context.crew_trainer ? context.crew_trainer : make_crew_trainer(data, settings, context.seed);
  const auto units =
      make_units(static_cast<std::size_t>(settings.builds), static_cast<std::size_t>(data.targets.cols()));
  std::vector<std::vector<ColumnOutcome>> outcomes(units.size());
  std::atomic<std::int64_t> done{0};
  const auto total = static_cast<std::int64_t>(settings.builds) * data.targets.cols();
  context.log->progress({context.task, 0, total, "networks"});
  base::parallel_for(
      units.size(), context.n_threads,
      [&](std::size_t i, int) {
        outcomes[i] = train_crew(units[i].i_build, units[i].columns, context.stop);
        const auto n = static_cast<std::int64_t>(units[i].columns.size());
        context.log->progress({context.task, done.fetch_add(n) + n, total, "networks"});
      },
      context.stop);
  return collect(data, settings.builds, units, outcomes);
}

ScreeningResult screen(const ScreeningData& data, const ScreenSettings& settings,
                       const ScreeningContext& context) {
  return settings.method == "fast" ? screen_fast(data, settings, context)
                                   : screen_networks(data, settings, context);
}

}  // namespace elrom::networks
