// The one place that knows which of LibTorch, MPI and XGBoost are part of this build.
#include <cstdlib>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/error.hpp"
#if ELROM_HAS_TORCH
#include "late_torch.hpp"
#endif
#if ELROM_HAS_MPI
#include "elrom/mpi/world.hpp"
#endif
#if ELROM_HAS_XGBOOST
#include "elrom/xgboost/trainer.hpp"
#endif

namespace elrom::programs {
namespace {

/// Whether a launcher (mpirun, mpiexec, srun) started this process beside others.
bool is_one_of_several() {
  for (const char* size : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    if (const char* text = std::getenv(size)) return std::atoi(text) > 1;
  }
  return false;
}

int work_alone(const StudyArguments& arguments, const StudyWork& work) {
  const auto settings = arguments.resolve();
  const auto log = arguments.log();
  return work(settings, {.trainer = make_network_trainer(settings.device)}, *log);
}

#if ELROM_HAS_MPI
int work_together(const StudyArguments& arguments, const StudyWork& work) {
  const auto stop =
      base::interrupt_token();  // before the ranks meet: one that failed alone would keep the others waiting
  const mpi::World world;
  if (world.rank() > 0) {
    // Settings are read with the first unit: when they are wrong, rank 0 says so once and there is none.
    world.serve([&] { return make_network_trainer(arguments.resolve().device); }, stop);
    return 0;
  }
  const auto settings = arguments.resolve();
  const auto log = arguments.log();
  const auto workers = world.workers();
  auto trainer = make_network_trainer(settings.device);
  if (trainer != nullptr) trainer = workers->trainer(std::move(trainer));
  return work(settings, {.trainer = std::move(trainer), .workers = workers.get()}, *log);
}
#else
int work_together(const StudyArguments&, const StudyWork&) {
  throw NotBuiltError({.what = "several processes need MPI, which this build left out",
                       .advice = "build with -DELROM_MPI=ON, or start one process"});
}
#endif

}  // namespace

std::shared_ptr<const networks::Trainer> make_network_trainer(const std::string& device) {
#if ELROM_HAS_TORCH
  return late_torch_trainer(device);
#else
  if (device != "cpu") {
    throw NotBuiltError({.what = "device " + device + " needs LibTorch, which this build left out",
                         .advice = "build with -DELROM_TORCH=ON"});
  }
  return nullptr;
#endif
}

std::shared_ptr<const surrogate::TreeTrainer> make_tree_trainer() {
#if ELROM_HAS_XGBOOST
  return elrom::xgboost::make_tree_trainer();
#else
  return surrogate::missing_tree_trainer();
#endif
}

int in_study(const StudyArguments& arguments, const StudyWork& work) {
  return is_one_of_several() ? work_together(arguments, work) : work_alone(arguments, work);
}

}  // namespace elrom::programs
