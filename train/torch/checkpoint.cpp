#include "checkpoint.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/io/tensor_file.hpp"

namespace elrom::torch {
namespace {

using Json = nlohmann::json;

io::Tensor to_file(const ::torch::Tensor& tensor) {
  const auto host = tensor.to(::torch::kCPU).contiguous();
  const auto n = static_cast<std::size_t>(host.numel());
  return io::Tensor::copy(std::span<const float>(host.data_ptr<float>(), n), {n});
}

void from_file(const io::TensorFile& file, const std::string& name, ::torch::Tensor& tensor) {
  file.verify(name);
  const auto values = file.tensor(name, std::array{static_cast<std::size_t>(tensor.numel())}).f32();
  tensor.copy_(::torch::from_blob(const_cast<float*>(values.data()), {tensor.numel()}, ::torch::kFloat32));
}

Json to_json(const Progress& progress) {
  return {{"epoch", progress.epoch},
          {"learning_rate", progress.learning_rate},
          {"backed_off", progress.backed_off},
          {"best_epoch", progress.best_epoch},
          {"best_validation", progress.best_validation},
          {"best_train", progress.best_train},
          {"history", progress.history}};
}

Progress from_json(const Json& json) {
  return {json.at("epoch").get<int>(),
          json.at("learning_rate").get<double>(),
          json.at("backed_off").get<bool>(),
          json.at("best_epoch").get<int>(),
          json.at("best_validation").get<double>(),
          json.at("best_train").get<double>(),
          json.at("history").get<std::vector<double>>()};
}

void load(const io::TensorFile& file, Training& training) {
  const Json state = Json::parse(file.text("state"));
  Progress progress = from_json(state.at("progress"));
  const auto n_steps = state.at("n_steps").get<std::int64_t>();
  from_file(file, "parameters", training.mlp().parameters());
  from_file(file, "best", training.best());
  from_file(file, "adam/mean", training.adam().mean());
  from_file(file, "adam/square", training.adam().square());
  training.adam().set_n_steps(n_steps);
  training.progress() = std::move(progress);
}

}  // namespace

std::string training_digest(const networks::TrainingProblem& problem,
                            const networks::Hyperparameters& hyperparameters,
                            const networks::TrainingBudget& budget, base::Seed seed) {
  return base::digest_of_members(problem, hyperparameters, budget, seed);
}

void save_checkpoint(const std::filesystem::path& path, const std::string& digest, Training& training) {
  io::TensorFile file;
  io::write_kind(file, io::kinds::checkpoint);
  file.set_text("training", digest);
  file.set_text(
      "state",
      Json{{"progress", to_json(training.progress())}, {"n_steps", training.adam().n_steps()}}.dump());
  file.set("parameters", to_file(training.mlp().parameters()));
  file.set("best", to_file(training.best()));
  file.set("adam/mean", to_file(training.adam().mean()));
  file.set("adam/square", to_file(training.adam().square()));
  file.write(path);
}

bool load_checkpoint(const std::filesystem::path& path, const std::string& digest, Training& training) {
  std::error_code ignored;
  if (path.empty() || !std::filesystem::exists(path, ignored)) return false;
  try {
    const auto file = io::TensorFile::open(path);
    io::check_kind(file, io::kinds::checkpoint);
    if (file.text("training") != digest) return false;
    load(file, training);
    return true;
  } catch (const InputError&) {
  } catch (const Json::exception&) {
  }
  training.restart(training.progress().learning_rate);
  return false;
}

}  // namespace elrom::torch
