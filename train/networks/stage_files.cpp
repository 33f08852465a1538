#include "elrom/networks/stage_files.hpp"

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::networks {
namespace {

double number_of(const io::TensorFile& file, const std::string& key) {
  const auto value = base::to_double(file.text(key));
  if (!value)
    throw InputError(
        {.what = "no number under '" + key + "'", .where = file.where(), .found = file.text(key)});
  return *value;
}

}  // namespace

io::TensorFile to_file(const ScreeningResult& screening) {
  io::TensorFile file;
  file.set("error", io::Tensor::copy(screening.error));
  file.set("build_error", io::Tensor::copy(screening.build_error));
  file.set_text("mean_epochs", base::number(screening.mean_epochs));
  return file;
}

ScreeningResult screening_of(const io::TensorFile& file) {
  return {file.tensor("error").matrix64(), file.tensor("build_error").matrix64(),
          number_of(file, "mean_epochs")};
}

io::TensorFile to_file(const TrainingResult& result) {
  io::TensorFile file;
  if (!result.diverged) result.network.save(file, "network");
  file.set_text("validation_mse", base::number(result.validation_mse));
  file.set_text("train_mse", base::number(result.train_mse));
  file.set_text("epochs", std::to_string(result.epochs));
  file.set_text("diverged", result.diverged ? "yes" : "no");
  return file;
}

TrainingResult training_of(const io::TensorFile& file) {
  TrainingResult result;
  result.diverged = file.text("diverged") == "yes";
  if (!result.diverged) result.network = model::Network::load(file, "network");
  result.validation_mse = number_of(file, "validation_mse");
  result.train_mse = number_of(file, "train_mse");
  result.epochs = static_cast<int>(number_of(file, "epochs"));
  return result;
}

namespace {

/// Under which the i-th ones' members stand.
std::string prefix_of(std::size_t i) { return std::to_string(i) + "/"; }

}  // namespace

io::TensorFile to_file(std::span<const Hyperparameters> hyperparameters, double validation_mse) {
  io::TensorFile file;
  for (std::size_t i = 0; i < hyperparameters.size(); ++i)
    for_each_hyperparameter(hyperparameters[i], [&](const char* name, const auto& value) {
      file.set_text(prefix_of(i) + name, text_of(value));
    });
  file.set_text("validation_mse", base::number(validation_mse));
  return file;
}

std::vector<Hyperparameters> hyperparameters_of(const io::TensorFile& file) {
  std::vector<Hyperparameters> all;
  do {
    const std::string prefix = prefix_of(all.size());
    for_each_hyperparameter(all.emplace_back(), [&](const char* name, auto& value) {
      read_text(file.text(prefix + name), value);
    });
  } while (file.texts().contains(prefix_of(all.size()) + Hyperparameters::names.front()));
  return all;
}

}  // namespace elrom::networks
