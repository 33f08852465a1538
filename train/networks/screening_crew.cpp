// A crew: some columns of one build of the screening, trained together with their own early stopping.
// Finished networks are compacted away, so that they stop costing.

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/networks/screening.hpp"
#include "lane_network.hpp"

namespace elrom::networks {
namespace {

constexpr std::size_t evaluation_rows =
    64;  // rows a forward pass evaluates at a time: stays in the first cache

// Weights of dead units decay into denormal numbers, which some processors compute a hundred times slower.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040U); }
  ~FlushDenormals() { _mm_setcsr(saved_); }

 private:
  unsigned saved_;
#endif
};

MatrixF gathered(const MatrixF& inputs, const std::vector<std::uint32_t>& rows, const LaneShape& shape) {
  MatrixF some(static_cast<Eigen::Index>(rows.size()), inputs.cols());
  for (std::size_t r = 0; r < rows.size(); ++r) some.row(static_cast<Eigen::Index>(r)) = inputs.row(rows[r]);
  return pad_inputs(some, shape);
}

// What all crews of a field share, laid out once.
struct ScreeningTables {
  ScreeningTables(const ScreeningData& data_, const ScreenSettings& settings_, base::Seed seed_)
      : data(data_),
        settings(settings_),
        seed(seed_),
        shape(static_cast<std::size_t>(data_.inputs.cols()), static_cast<std::size_t>(settings_.n_units)),
        train(data_.rows(Part::train)),
        validation(data_.rows(Part::validation)),
        judging(data_.judging_rows()),
        validation_inputs(gathered(data_.inputs, validation, shape)),
        judging_inputs(gathered(data_.inputs, judging, shape)) {}

  const ScreeningData& data;
  const ScreenSettings& settings;
  base::Seed seed;
  LaneShape shape;
  std::vector<std::uint32_t> train, validation, judging;
  MatrixF validation_inputs, judging_inputs;  // padded, (rows, shape.k)
};

// A column in training.
struct Learner {
  std::uint32_t place = 0;  // in the crew's list
  std::uint32_t column = 0;
  double best = HUGE_VAL;
  int waited = 0, epochs = 0;
  ColumnParameters weights;  // of the best epoch
};

// Sixteen learners in lanes with all that their steps touch.
struct Group {
  Group(const LaneShape& shape) : parameters(shape.n_parameters()), adam(shape.n_parameters()) {}
  LaneBuffer parameters;
  LaneAdam adam;
  LaneBuffer train_targets, validation_targets;
  std::vector<std::size_t> learners;  // by lane; fewer than n_lanes in the last group
};

struct Scratch {
  Scratch(const LaneShape& shape, std::size_t n_rows)
      : x(n_rows * shape.k),
        activations(n_rows * shape.u),
        y(n_rows),
        error(n_rows),
        gradient(shape.n_parameters()) {}
  std::vector<float> x;
  LaneBuffer activations, y, error, gradient;
};

class Crew {
 public:
  Crew(const ScreeningTables& tables, std::size_t i_build, std::span<const std::uint32_t> columns)
      : tables_(tables),
        i_build_(i_build),
        batch_(
            std::min<std::size_t>(static_cast<std::size_t>(tables.settings.batch_size), tables.train.size())),
        scratch_(tables.shape, std::max(evaluation_rows, (batch_ + tile - 1) / tile * tile)) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      learners_.push_back({.place = static_cast<std::uint32_t>(i), .column = columns[i], .weights = {}});
    }
    for (std::size_t i = 0; i < columns.size(); i += n_lanes) start_group(i);
  }

  void train(const std::stop_token& stop) {
    for (int epoch = 0; epoch < tables_.settings.max_epochs && !groups_.empty(); ++epoch) {
      if (stop.stop_requested()) throw Interrupted("stopped on request");
      const auto order = epoch_order(tables_.seed, i_build_, static_cast<std::size_t>(epoch),
                                     tables_.train.size(), tables_.settings.epoch_records);
      gather_inputs(order);
      for (auto& group : groups_) train_epoch(group, order);
      n_steps_ += (order.size() + batch_ - 1) / batch_;
      for (auto& group : groups_) judge_epoch(group);
      compact();
    }
  }

  std::vector<ColumnOutcome> outcomes() {
    std::vector<ColumnOutcome> outcomes(learners_.size());
    for (std::size_t i = 0; i < learners_.size(); i += n_lanes) judge_group(i, outcomes);
    return outcomes;
  }

 private:
  void start_group(std::size_t first) {
    Group group(tables_.shape);
    for (std::size_t i = first; i < std::min(first + n_lanes, learners_.size()); ++i) {
      put_lane(group.parameters, i - first, initial_lane(learners_[i].column));
      learners_[i].weights = get_lane(group.parameters, i - first);
      group.learners.push_back(i);
    }
    pack_targets(group);
    groups_.push_back(std::move(group));
  }

  ColumnParameters initial_lane(std::uint32_t column) const {
    const auto& shape = tables_.shape;
    const auto network = initial_network(tables_.seed, i_build_, column, shape.n_inputs, shape.n_units);
    ColumnParameters lane(shape.n_parameters(), 0.0F);
    for (std::size_t j = 0; j < shape.n_units; ++j) {
      for (std::size_t k = 0; k <= shape.n_inputs; ++k) {
        lane[k * shape.u + j] = network.hidden(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k));
      }
      lane[shape.k * shape.u + j] = network.output[j];
    }
    lane.back() = network.output.back();
    return lane;
  }

  LaneBuffer packed(const std::vector<std::uint32_t>& rows, const std::vector<std::size_t>& learners) const {
    LaneBuffer targets((rows.size() + tile - 1) / tile * tile);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (std::size_t lane = 0; lane < learners.size(); ++lane) {
        targets[r].value[lane] = tables_.data.targets(rows[r], learners_[learners[lane]].column);
      }
    }
    return targets;
  }

  void pack_targets(Group& group) const {
    group.train_targets = packed(tables_.train, group.learners);
    group.validation_targets = packed(tables_.validation, group.learners);
  }

  // The epoch's inputs in the order of its batches, each batch padded to whole tiles; shared by all groups.
  void gather_inputs(const std::vector<std::uint32_t>& order) {
    const auto& shape = tables_.shape;
    const std::size_t batch_rows = (batch_ + tile - 1) / tile * tile;
    const std::size_t n_batches = (order.size() + batch_ - 1) / batch_;
    epoch_inputs_.assign(n_batches * batch_rows * shape.k, 0.0F);
    for (std::size_t i = 0; i < order.size(); ++i) {
      float* x = &epoch_inputs_[((i / batch_) * batch_rows + i % batch_) * shape.k];
      const float* from = &tables_.data.inputs(tables_.train[order[i]], 0);
      std::copy_n(from, shape.n_inputs, x);
      x[shape.n_inputs] = 1;
    }
  }

  void train_epoch(Group& group, const std::vector<std::uint32_t>& order) {
    const auto& shape = tables_.shape;
    const std::size_t batch_rows = (batch_ + tile - 1) / tile * tile;
    const std::size_t n_batches = (order.size() + batch_ - 1) / batch_;
    for (std::size_t b = 0; b < n_batches; ++b) {
      const std::size_t first = b * batch_, n = std::min(batch_, order.size() - first);
      const std::size_t n_rows = (n + tile - 1) / tile * tile;
      const float* x = &epoch_inputs_[b * batch_rows * shape.k];
      lanes_forward(shape, group.parameters, x, n_rows, scratch_.activations.data(), scratch_.y.data());
      loss_gradient(group, std::span(order).subspan(first, n), n_rows);
      lanes_backward(shape, group.parameters, x, n_rows, scratch_.activations.data(), scratch_.error.data(),
                     scratch_.gradient);
      group.adam.step(group.parameters, scratch_.gradient, tables_.settings.learning_rate, n_steps_ + b + 1);
    }
  }

  // error <- d (mean of squares) / d y; rows of padding count nothing.
  void loss_gradient(const Group& group, std::span<const std::uint32_t> order, std::size_t n_rows) {
    const float scale = 2.0F / static_cast<float>(order.size());
    for (std::size_t r = 0; r < order.size(); ++r) {
      const auto& target = group.train_targets[order[r]];
      for (std::size_t lane = 0; lane < n_lanes; ++lane) {
        scratch_.error[r].value[lane] = scale * (scratch_.y[r].value[lane] - target.value[lane]);
      }
    }
    for (std::size_t r = order.size(); r < n_rows; ++r) scratch_.error[r] = Lane16{};
  }

  /// Calls each(row, squared errors of the lanes) for every row.
  template <class Each>
  void squared_errors(const LaneBuffer& parameters, const MatrixF& x, std::size_t n_rows,
                      const LaneBuffer& targets, const Each& each) {
    for (std::size_t first = 0; first < n_rows; first += evaluation_rows) {
      const std::size_t n = std::min(evaluation_rows, n_rows - first), whole = (n + tile - 1) / tile * tile;
      lanes_forward(tables_.shape, parameters, x.row(static_cast<Eigen::Index>(first)).data(), whole,
                    scratch_.activations.data(), scratch_.y.data());
      for (std::size_t r = 0; r < n; ++r) {
        Lane16 square;
        for (std::size_t lane = 0; lane < n_lanes; ++lane) {
          const float e = scratch_.y[r].value[lane] - targets[first + r].value[lane];
          square.value[lane] = e * e;
        }
        each(first + r, square);
      }
    }
  }

  void judge_epoch(Group& group) {
    std::array<double, n_lanes> sum{};
    squared_errors(group.parameters, tables_.validation_inputs, tables_.validation.size(),
                   group.validation_targets, [&](std::size_t, const Lane16& square) {
                     for (std::size_t lane = 0; lane < n_lanes; ++lane) sum[lane] += square.value[lane];
                   });
    for (std::size_t lane = 0; lane < group.learners.size(); ++lane) {
      auto& learner = learners_[group.learners[lane]];
      ++learner.epochs;
      if (sum[lane] < learner.best) {  // false for NaN: a network that diverged waits its patience out
        learner.best = sum[lane];
        learner.waited = 0;
        learner.weights = get_lane(group.parameters, lane);
      } else {
        ++learner.waited;
      }
    }
  }

  bool finished(std::size_t learner) const { return learners_[learner].waited >= tables_.settings.patience; }

  // Moves the living into as few groups as hold them, when that saves a group.
  void compact() {
    std::vector<std::pair<std::size_t, std::size_t>> living;  // group, lane
    for (std::size_t g = 0; g < groups_.size(); ++g) {
      for (std::size_t lane = 0; lane < groups_[g].learners.size(); ++lane) {
        if (!finished(groups_[g].learners[lane])) living.emplace_back(g, lane);
      }
    }
    if ((living.size() + n_lanes - 1) / n_lanes == groups_.size()) return;
    std::vector<Group> packed_groups;
    for (std::size_t i = 0; i < living.size(); i += n_lanes) {
      Group group(tables_.shape);
      for (std::size_t lane = 0; lane < std::min(n_lanes, living.size() - i); ++lane) {
        const auto [g, from_lane] = living[i + lane];
        copy_lane(group.parameters, lane, groups_[g].parameters, from_lane);
        group.adam.copy_lane(lane, groups_[g].adam, from_lane);
        group.learners.push_back(groups_[g].learners[from_lane]);
      }
      pack_targets(group);
      packed_groups.push_back(std::move(group));
    }
    groups_ = std::move(packed_groups);
  }

  void judge_group(std::size_t first, std::vector<ColumnOutcome>& outcomes) {
    LaneBuffer parameters(tables_.shape.n_parameters());
    std::vector<std::size_t> members;
    for (std::size_t i = first; i < std::min(first + n_lanes, learners_.size()); ++i) {
      put_lane(parameters, i - first, learners_[i].weights);
      members.push_back(i);
      outcomes[i].plane_error.assign(tables_.data.n_planes, 0.0);
      outcomes[i].epochs = learners_[i].epochs;
    }
    squared_errors(parameters, tables_.judging_inputs, tables_.judging.size(),
                   packed(tables_.judging, members), [&](std::size_t r, const Lane16& square) {
                     const auto plane = static_cast<std::size_t>(tables_.data.plane[tables_.judging[r]]);
                     for (std::size_t m = 0; m < members.size(); ++m) {
                       outcomes[members[m]].plane_error[plane] += square.value[m];
                       outcomes[members[m]].error +=
                           square.value[m] / static_cast<double>(tables_.judging.size());
                     }
                   });
  }

  const ScreeningTables& tables_;
  std::size_t i_build_, batch_, n_steps_ = 0;
  std::vector<Learner> learners_;
  std::vector<Group> groups_;
  std::vector<float> epoch_inputs_;
  Scratch scratch_;
};

}  // namespace

CrewTrainer make_crew_trainer(const ScreeningData& data, const ScreenSettings& settings, base::Seed seed) {
  const auto tables = std::make_shared<const ScreeningTables>(data, settings, seed);
  return [tables](std::size_t i_build, std::span<const std::uint32_t> columns, const std::stop_token& stop) {
    const FlushDenormals flush;
    Crew crew(*tables, i_build, columns);
    crew.train(stop);
    return crew.outcomes();
  };
}

}  // namespace elrom::networks
