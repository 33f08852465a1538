#include "units.hpp"

#include <nlohmann/json.hpp>

#include "elrom/base/members.hpp"
#include "elrom/networks/stage_files.hpp"

namespace elrom::mpi {
namespace {

using Json = nlohmann::json;

// The matrices of a problem under their numbers in a message, alike for writing and reading.
template <class Problem, class Work>
void for_every_matrix(Problem& problem, const Work& work) {
  int i = 0;
  base::for_each_member(problem, [&](auto& matrix) { work("problem/" + std::to_string(i++), matrix); });
}

// Every member in its order: both sides are the same program.
template <class T>
Json to_json(const T& value) {
  if constexpr (std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string>) {
    return value;
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<std::int64_t>(value);
  } else {
    Json json = Json::array();
    base::for_each_member(value, [&](const auto& member) { json.push_back(to_json(member)); });
    return json;
  }
}

template <class T>
void from_json(const Json& json, T& value) {
  if constexpr (std::is_arithmetic_v<T> || std::is_convertible_v<T, std::string>) {
    json.get_to(value);
  } else if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(json.get<std::int64_t>());
  } else {
    std::size_t i = 0;
    base::for_each_member(value, [&](auto& member) { from_json(json.at(i++), member); });
  }
}

template <class T>
T from_json(const Json& json) {
  T value;
  from_json(json, value);
  return value;
}

}  // namespace

io::TensorFile message(const char* kind) {
  io::TensorFile message;
  message.set_text("kind", kind);
  return message;
}

io::TensorFile to_message(const TrainUnit& unit) {
  auto unit_message = message(kind::train);
  unit_message.set_text("unit", Json{{"hyperparameters", to_json(unit.hyperparameters)},
                                     {"budget", to_json(unit.budget)},
                                     {"seed", unit.seed.value()},
                                     {"monitored", unit.monitored}}
                                    .dump());
  // Bytes, not JSON: a folder's name need not be UTF-8.
  const auto path = std::span(unit.checkpoint.data(), unit.checkpoint.size());
  const auto bytes = std::vector<std::uint8_t>(path.begin(), path.end());
  unit_message.set("checkpoint", io::Tensor::copy(bytes, {bytes.size()}));
  return unit_message;
}

TrainUnit train_unit_of(const io::TensorFile& message) {
  const auto json = Json::parse(message.text("unit"));
  const auto path = message.tensor("checkpoint").u8();
  return {.hyperparameters = from_json<networks::Hyperparameters>(json.at("hyperparameters")),
          .budget = from_json<networks::TrainingBudget>(json.at("budget")),
          .seed = base::Seed(json.at("seed").get<std::uint64_t>()),
          .monitored = json.at("monitored"),
          .checkpoint = {path.begin(), path.end()}};
}

void add_data(io::TensorFile& message, const networks::TrainingProblem& problem) {
  for_every_matrix(problem, [&](const std::string& name, const MatrixF& matrix) {
    if (matrix.size() > 0) message.set(name, io::Tensor::copy(matrix));
  });
}

bool has_problem(const io::TensorFile& message) { return message.has("problem/0"); }

networks::TrainingProblem problem_of(const io::TensorFile& message) {
  networks::TrainingProblem problem;
  for_every_matrix(problem, [&](const std::string& name, MatrixF& matrix) {
    if (message.has(name)) matrix = message.tensor(name).matrix();
  });
  return problem;
}

std::string digest_of(const networks::TrainingProblem& problem) { return base::digest_of_members(problem); }

io::TensorFile to_message(const CrewUnit& unit) {
  auto unit_message = message(kind::crew);
  unit_message.set_text("unit", Json{{"i_build", unit.i_build}, {"columns", unit.columns}}.dump());
  return unit_message;
}

CrewUnit crew_unit_of(const io::TensorFile& message) {
  const auto json = Json::parse(message.text("unit"));
  return {json.at("i_build"), json.at("columns")};
}

void add_data(io::TensorFile& message, const networks::ScreeningData& data,
              const networks::ScreenSettings& settings, base::Seed seed) {
  std::vector<std::uint8_t> part;
  for (const auto of_record : data.part) part.push_back(static_cast<std::uint8_t>(of_record));
  message.set("inputs", io::Tensor::copy(data.inputs));
  message.set("targets", io::Tensor::copy(data.targets));
  message.set("plane", io::Tensor::copy(data.plane, {data.plane.size()}));
  message.set("case_of", io::Tensor::copy(data.case_of, {data.case_of.size()}));
  message.set("part", io::Tensor::copy(part, {part.size()}));
  message.set_text(
      "screening",
      Json{{"n_planes", data.n_planes}, {"settings", to_json(settings)}, {"seed", seed.value()}}.dump());
}

bool has_screening(const io::TensorFile& message) { return message.has_text("screening"); }

std::unique_ptr<const Screening> screening_job_of(const io::TensorFile& message) {
  const auto json = Json::parse(message.text("screening"));
  const auto plane = message.tensor("plane").i32(), case_of = message.tensor("case_of").i32();
  auto screening = std::make_unique<Screening>();
  screening->settings = from_json<networks::ScreenSettings>(json.at("settings"));
  screening->seed = base::Seed(json.at("seed").get<std::uint64_t>());
  screening->data = {.inputs = message.tensor("inputs").matrix(),
                     .targets = message.tensor("targets").matrix(),
                     .plane = {plane.begin(), plane.end()},
                     .case_of = {case_of.begin(), case_of.end()},
                     .part = {},
                     .n_planes = json.at("n_planes")};
  for (const auto of_record : message.tensor("part").u8())
    screening->data.part.push_back(static_cast<networks::Part>(of_record));
  return screening;
}

io::TensorFile to_message(const networks::TrainingResult& result) {
  auto answer = networks::to_file(result);
  answer.set_text("kind", kind::result);
  answer.set_text("pruned", result.pruned ? "yes" : "no");
  answer.set_text("backed_off", result.backed_off ? "yes" : "no");
  return answer;
}

networks::TrainingResult training_result_of(const io::TensorFile& message) {
  auto result = networks::training_of(message);
  result.pruned = message.text("pruned") == "yes";
  result.backed_off = message.text("backed_off") == "yes";
  return result;
}

io::TensorFile to_message(const std::vector<networks::ColumnOutcome>& outcomes) {
  const auto n = static_cast<Eigen::Index>(outcomes.size());
  const auto n_planes = outcomes.empty() ? 0 : static_cast<Eigen::Index>(outcomes.front().plane_error.size());
  MatrixD plane_error(n, n_planes), rest(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& outcome = outcomes[static_cast<std::size_t>(i)];
    plane_error.row(i) = Eigen::RowVectorXd::Map(outcome.plane_error.data(), n_planes);
    rest.row(i) << outcome.error, outcome.epochs;
  }
  auto answer = message(kind::result);
  answer.set("plane_error", io::Tensor::copy(plane_error));
  answer.set("rest", io::Tensor::copy(rest));
  return answer;
}

std::vector<networks::ColumnOutcome> outcomes_of(const io::TensorFile& message) {
  const auto plane_error = message.tensor("plane_error").matrix64(), rest = message.tensor("rest").matrix64();
  std::vector<networks::ColumnOutcome> outcomes;
  for (Eigen::Index i = 0; i < rest.rows(); ++i) {
    const auto* planes = plane_error.row(i).data();
    outcomes.push_back({.plane_error = {planes, planes + plane_error.cols()},
                        .error = rest(i, 0),
                        .epochs = static_cast<int>(rest(i, 1))});
  }
  return outcomes;
}

io::TensorFile failure(ExitStatus status, const std::string& what) {
  auto answer = message(kind::failure);
  answer.set_text("status", std::to_string(static_cast<int>(status)));
  answer.set_text("what", what);
  return answer;
}

void rethrow(const io::TensorFile& failure, int rank) {
  const auto status = static_cast<ExitStatus>(std::stoi(failure.text("status")));
  const auto what = "rank " + std::to_string(rank) + ": " + failure.text("what");
  if (status == ExitStatus::numerical) throw NumericalError(what);  // `auto` goes on without the candidate
  if (status == ExitStatus::interrupted) throw Interrupted(what);
  throw Error(status, {.what = what});
}

}  // namespace elrom::mpi
