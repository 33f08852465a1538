#include "workers.hpp"

#include <atomic>
#include <exception>
#include <utility>

#include "units.hpp"

namespace elrom::mpi {
namespace {

/// Sends a unit and sees it through, so that the rank is free for the next one also when `monitor` (which may
/// be missing) or the unit throws.
io::TensorFile converse(Channel& channel, int rank, const io::TensorFile& unit,
                        networks::TrainingMonitor* monitor, const std::stop_token& stop) {
  channel.send(rank, unit);
  std::exception_ptr failure_here;
  const auto goes_on = [&](const io::TensorFile& report) {
    const auto epoch = report.tensor("epoch").f64();
    try {
      return monitor == nullptr || monitor->keep_going(static_cast<int>(epoch[0]), epoch[1]);
    } catch (...) {
      failure_here = std::current_exception();
      return false;
    }
  };
  Patience patience;
  for (bool told = false;;) {
    const auto answer = channel.poll(rank);
    if (!answer) {
      // A worker that was told to stop still answers: its Interrupted becomes this process's own.
      if (stop.stop_requested() && !std::exchange(told, true)) channel.send(rank, message(kind::stop));
      patience.wait();
      continue;
    }
    patience = {};
    const auto& about = answer->text("kind");
    if (about == kind::epoch) {
      channel.send(rank, message(goes_on(*answer) ? kind::go_on : kind::give_up));
      continue;
    }
    if (failure_here != nullptr) std::rethrow_exception(failure_here);
    if (about == kind::failure) rethrow(*answer, rank);
    return *answer;
  }
}

class SharedTrainer final : public networks::Trainer {
 public:
  SharedTrainer(Channel& channel, Places& places, std::shared_ptr<const networks::Trainer> here)
      : channel_(channel), places_(places), here_(std::move(here)) {}

  // Stages carry the trainer's name in their digests: who trained is no part of what came out.
  [[nodiscard]] std::string name() const override { return here_->name(); }

  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters& hyperparameters,
                                               const networks::TrainingBudget& budget, base::Seed seed,
                                               networks::TrainingMonitor* monitor,
                                               const std::stop_token& stop,
                                               const std::filesystem::path& checkpoint) const override {
    const auto data = "problem " + digest_of(problem);
    auto lease = places_.lease(data);
    if (lease.rank() == 0)
      return here_->train(problem, hyperparameters, budget, seed, monitor, stop, checkpoint);
    auto unit = to_message(TrainUnit{
        .hyperparameters = hyperparameters,
        .budget = budget,
        .seed = seed,
        .monitored = monitor != nullptr,
        .checkpoint = checkpoint.empty() ? std::string() : std::filesystem::absolute(checkpoint).string()});
    if (lease.bring(data)) add_data(unit, problem);
    return training_result_of(converse(channel_, lease.rank(), unit, monitor, stop));
  }

 private:
  Channel& channel_;
  Places& places_;
  std::shared_ptr<const networks::Trainer> here_;
};

class Ranks final : public networks::Workers {
 public:
  explicit Ranks(Channel& channel) : channel_(channel), places_(channel.size()) {}

  [[nodiscard]] int n_units() const override { return channel_.size(); }

  [[nodiscard]] networks::CrewTrainer crew_trainer(const networks::ScreeningData& data,
                                                   const networks::ScreenSettings& settings,
                                                   base::Seed seed) const override {
    const auto name = "screening " + std::to_string(++n_screenings_);
    const auto here = networks::make_crew_trainer(data, settings, seed);
    return [this, name, here, &data, &settings, seed](
               std::size_t i_build, std::span<const std::uint32_t> columns, const std::stop_token& stop) {
      auto lease = places_.lease(name);
      if (lease.rank() == 0) return here(i_build, columns, stop);
      auto unit = to_message(CrewUnit{i_build, {columns.begin(), columns.end()}});
      if (lease.bring(name)) add_data(unit, data, settings, seed);
      return outcomes_of(converse(channel_, lease.rank(), unit, nullptr, stop));
    };
  }

  [[nodiscard]] std::shared_ptr<const networks::Trainer> trainer(
      std::shared_ptr<const networks::Trainer> here) const override {
    return std::make_shared<SharedTrainer>(channel_, places_, std::move(here));
  }

 private:
  Channel& channel_;
  mutable Places places_;
  mutable std::atomic<int> n_screenings_{0};
};

}  // namespace

bool Places::Lease::bring(const std::string& data) {
  auto& held = places_.places_[static_cast<std::size_t>(rank_)].data;
  if (held == data) return false;
  held = data;
  return true;
}

Places::Lease Places::lease(const std::string& data) {
  std::unique_lock lock(mutex_);
  for (;;) {
    Place* best = nullptr;
    for (auto& place : places_) {
      if (place.taken) continue;
      if (best == nullptr || place.data == data) best = &place;
    }
    if (best != nullptr) {
      best->taken = true;
      return {*this, static_cast<int>(best - places_.data())};
    }
    freed_.wait(lock);
  }
}

void Places::give_back(int rank) {
  const std::scoped_lock lock(mutex_);
  places_[static_cast<std::size_t>(rank)].taken = false;
  freed_.notify_one();
}

std::unique_ptr<networks::Workers> make_workers(Channel& channel) { return std::make_unique<Ranks>(channel); }

}  // namespace elrom::mpi
