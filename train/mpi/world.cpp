#include "elrom/mpi/world.hpp"

#include "channel.hpp"
#include "elrom/base/error.hpp"
#include "units.hpp"
#include "workers.hpp"

namespace elrom::mpi {
namespace {

/// Tells rank 0 of every epoch where it wants to know, and hears when the run is stopped.
class Reporter final : public networks::TrainingMonitor {
 public:
  Reporter(Channel& channel, bool monitored, std::stop_source& stop)
      : channel_(channel), monitored_(monitored), stop_(stop) {}

  bool keep_going(int epoch, double validation_mse) override {
    if (!monitored_) {
      if (const auto word = channel_.poll(0)) (void)heed(*word);
      return true;
    }
    auto report = message(kind::epoch);
    report.set("epoch",
               io::Tensor::copy(std::vector<double>{static_cast<double>(epoch), validation_mse}, {2}));
    channel_.send(0, report);
    for (;;) {
      const auto word = channel_.receive(0);
      if (heed(word)) return word.text("kind") == kind::go_on;
    }
  }

 private:
  /// @return whether the word answers an epoch
  [[nodiscard]] bool heed(const io::TensorFile& word) {
    if (word.text("kind") != kind::stop) return true;
    stop_.request_stop();
    return false;
  }

  Channel& channel_;
  bool monitored_;
  std::stop_source& stop_;
};

/// A rank that trains for rank 0, with the data of its last unit.
class Worker {
 public:
  using MakeTrainer = std::function<std::shared_ptr<const networks::Trainer>()>;
  Worker(Channel& channel, const MakeTrainer& make_trainer, const std::stop_token& stop)
      : channel_(channel), make_trainer_(make_trainer), stop_(stop) {}

  [[nodiscard]] io::TensorFile answer(const io::TensorFile& unit) {
    try {
      return unit.text("kind") == kind::train ? train(unit) : train_crew(unit);
    } catch (const Error& error) {
      return failure(error.status(), error.what());
    } catch (const std::exception& error) {
      return failure(ExitStatus::internal, error.what());
    }
  }

 private:
  io::TensorFile train(const io::TensorFile& message) {
    if (has_problem(message)) {
      crews_ = nullptr, screening_.reset();
      problem_ = problem_of(message);
    }
    if (trainer_ == nullptr) trainer_ = make_trainer_();
    const auto unit = train_unit_of(message);
    std::stop_source told;
    const std::stop_callback pass_on(stop_, [&told] { told.request_stop(); });
    Reporter reporter(channel_, unit.monitored, told);
    return to_message(trainer_->train(problem_, unit.hyperparameters, unit.budget, unit.seed, &reporter,
                                      told.get_token(), reachable(unit.checkpoint)));
  }

  io::TensorFile train_crew(const io::TensorFile& message) {
    if (has_screening(message)) {
      problem_ = {};
      screening_ = screening_job_of(message);
      crews_ = networks::make_crew_trainer(screening_->data, screening_->settings, screening_->seed);
    }
    const auto unit = crew_unit_of(message);
    return to_message(crews_(unit.i_build, unit.columns, stop_));
  }

  // The study's folder is rank 0's; other machines may not have it.
  static std::filesystem::path reachable(const std::filesystem::path& checkpoint) {
    std::error_code ignored;
    return std::filesystem::is_directory(checkpoint.parent_path(), ignored) ? checkpoint
                                                                            : std::filesystem::path();
  }

  Channel& channel_;
  const MakeTrainer& make_trainer_;
  const std::stop_token& stop_;
  std::shared_ptr<const networks::Trainer> trainer_;
  networks::TrainingProblem problem_;
  std::unique_ptr<const Screening> screening_;
  networks::CrewTrainer crews_;
};

}  // namespace

class World::Impl {
 public:
  Channel channel;
};

World::World() : impl_(std::make_unique<Impl>()) {}

World::~World() {
  if (rank() != 0) return;
  for (int other = 1; other < size(); ++other) impl_->channel.send(other, message(kind::end));
}

int World::rank() const { return impl_->channel.rank(); }
int World::size() const { return impl_->channel.size(); }

std::unique_ptr<networks::Workers> World::workers() const { return make_workers(impl_->channel); }

void World::serve(const std::function<std::shared_ptr<const networks::Trainer>()>& make_trainer,
                  const std::stop_token& stop) const {
  try {
    Worker worker(impl_->channel, make_trainer, stop);
    for (;;) {
      const auto word = impl_->channel.receive(0);
      const auto& about = word.text("kind");
      if (about == kind::end) return;
      // A stop may cross the answer of a unit that had just ended.
      if (about == kind::stop) continue;
      impl_->channel.send(0, worker.answer(word));
    }
  } catch (const std::exception& error) {
    impl_->channel.abort(error.what());
  }
}

}  // namespace elrom::mpi
