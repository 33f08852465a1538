#pragma once
// Units of training as messages, and the answers to them. The data of a unit travels only to a rank that does
// not hold it yet: a rank keeps what it was sent last.

#include <memory>
#include <string>

#include "elrom/base/error.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/networks/screening.hpp"
#include "elrom/networks/trainer.hpp"

namespace elrom::mpi {

/// What a message is about, under the text "kind".
namespace kind {
inline constexpr const char* train = "train";      ///< to a worker: a unit for networks::Trainer
inline constexpr const char* crew = "crew";        ///< to a worker: a unit for networks::CrewTrainer
inline constexpr const char* go_on = "go_on";      ///< to a worker: its training goes on
inline constexpr const char* give_up = "give_up";  ///< to a worker: its training is pruned
inline constexpr const char* stop = "stop";        ///< to a worker: the user stops the run
inline constexpr const char* end = "end";          ///< to a worker: the run has ended
inline constexpr const char* epoch = "epoch";      ///< from a worker: validation error of an epoch
inline constexpr const char* result = "result";    ///< from a worker
inline constexpr const char* failure = "failure";  ///< from a worker: the exception that ended the unit
}  // namespace kind

[[nodiscard]] io::TensorFile message(const char* kind);

struct TrainUnit {
  networks::Hyperparameters hyperparameters;
  networks::TrainingBudget budget;
  base::Seed seed{0};
  bool monitored = false;
  std::string checkpoint;
};
[[nodiscard]] io::TensorFile to_message(const TrainUnit& unit);
[[nodiscard]] TrainUnit train_unit_of(const io::TensorFile& message);
void add_data(io::TensorFile& message, const networks::TrainingProblem& problem);
[[nodiscard]] bool has_problem(const io::TensorFile& message);
[[nodiscard]] networks::TrainingProblem problem_of(const io::TensorFile& message);
[[nodiscard]] std::string digest_of(const networks::TrainingProblem& problem);

struct CrewUnit {
  std::size_t i_build = 0;
  std::vector<std::uint32_t> columns;
};
/// What a worker needs to train crews of one field.
struct Screening {
  networks::ScreeningData data;
  networks::ScreenSettings settings;
  base::Seed seed{0};
};
[[nodiscard]] io::TensorFile to_message(const CrewUnit& unit);
[[nodiscard]] CrewUnit crew_unit_of(const io::TensorFile& message);
void add_data(io::TensorFile& message, const networks::ScreeningData& data,
              const networks::ScreenSettings& settings, base::Seed seed);
[[nodiscard]] bool has_screening(const io::TensorFile& message);
[[nodiscard]] std::unique_ptr<const Screening> screening_job_of(const io::TensorFile& message);

[[nodiscard]] io::TensorFile to_message(const networks::TrainingResult& result);
[[nodiscard]] networks::TrainingResult training_result_of(const io::TensorFile& message);
[[nodiscard]] io::TensorFile to_message(const std::vector<networks::ColumnOutcome>& outcomes);
[[nodiscard]] std::vector<networks::ColumnOutcome> outcomes_of(const io::TensorFile& message);

[[nodiscard]] io::TensorFile failure(ExitStatus status, const std::string& what);
/// Throws what the worker could not: the same type where somebody catches it. @param rank for the message
[[noreturn]] void rethrow(const io::TensorFile& failure, int rank);

}  // namespace elrom::mpi
