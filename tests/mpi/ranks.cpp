// Two ranks with a trainer of a few lines, for what elrom-train cannot be made to do at will.
//   monitor  what watches a training at rank 0 fails while rank 1 trains
//   memory   rank 1 has no room for the data it is sent
#include <sys/resource.h>

#include <cstdio>
#include <fstream>
#include <future>
#include <thread>

#include "elrom/base/app.hpp"
#include "elrom/mpi/world.hpp"
#include "support/random_network.hpp"

namespace elrom::mpi {
namespace {

constexpr int n_epochs = 10;

class CountingTrainer final : public networks::Trainer {
 public:
  [[nodiscard]] std::string name() const override { return "counting"; }
  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem&,
                                               const networks::Hyperparameters&,
                                               const networks::TrainingBudget&, base::Seed seed,
                                               networks::TrainingMonitor* monitor, const std::stop_token&,
                                               const std::filesystem::path&) const override {
    networks::TrainingResult result;
    result.network = test::random_network({2, 3, 1}, model::Activation::relu, seed);
    while (!result.pruned && result.epochs < n_epochs) {
      result.pruned = !monitor->keep_going(++result.epochs, 1.0);
    }
    return result;
  }
};

class Watch final : public networks::TrainingMonitor {
 public:
  explicit Watch(std::function<void(int)> at_epoch) : at_epoch_(std::move(at_epoch)) {}
  bool keep_going(int epoch, double) override {
    at_epoch_(epoch);
    return true;
  }

 private:
  std::function<void(int)> at_epoch_;
};

networks::TrainingProblem problem(Eigen::Index n_records) {
  networks::TrainingProblem problem;
  problem.train_inputs = problem.validation_inputs =
      MatrixF::Constant(n_records, 2, static_cast<float>(n_records));
  problem.train_targets = problem.validation_targets = MatrixF::Zero(n_records, 1);
  return problem;
}

int train_through(const networks::Trainer& trainer, Eigen::Index n_records,
                  const std::function<void(int)>& at_epoch) {
  Watch watch(at_epoch);
  return trainer.train(problem(n_records), {}, {}, base::Seed(1), &watch, {}, {}).epochs;
}

/// Two trainings: the first is held at this rank, so that `at_rank_1` finds only the other rank free.
void beside_a_training_here(const networks::Trainer& trainer, const std::function<void()>& at_rank_1) {
  std::promise<void> begun, done;
  std::jthread here([&] {
    (void)train_through(trainer, 3, [&](int epoch) {
      if (epoch != 1) return;
      begun.set_value();
      done.get_future().wait();
    });
  });
  begun.get_future().wait();
  at_rank_1();
  done.set_value();
}

std::size_t address_space() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * 4096;
}

int run(const std::string& what) {
  const World world;
  const auto local = std::make_shared<const CountingTrainer>();
  if (world.rank() > 0) {
    constexpr rlim_t room = 64u << 20;
    const rlimit limit{address_space() + room, RLIM_INFINITY};
    if (what == "memory") setrlimit(RLIMIT_AS, &limit);
    world.serve([&] { return local; }, {});
    return 0;
  }
  const auto workers = world.workers();
  const auto trainer = workers->trainer(local);
  beside_a_training_here(*trainer, [&] {
    if (what == "memory") (void)train_through(*trainer, 20'000'000, [](int) {});
    try {
      (void)train_through(*trainer, 4, [](int epoch) {
        if (epoch == 2) throw std::runtime_error("disk full");
      });
    } catch (const std::runtime_error& error) {
      std::printf("caught %s\n", error.what());
    }
    std::printf("then %d epochs\n", train_through(*trainer, 4, [](int) {}));
  });
  return 0;
}

}  // namespace
}  // namespace elrom::mpi

int main(int argc, char** argv) {
  return elrom::base::run_app("ranks", [&] { return elrom::mpi::run(argc > 1 ? argv[1] : ""); });
}
