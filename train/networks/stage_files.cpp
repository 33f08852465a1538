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

io::TensorFile to_file(const Hyperparameters& h, double validation_mse) {
  io::TensorFile file;
  file.set_text("learning_rate", base::number(h.learning_rate));
  file.set_text("n_layers", std::to_string(h.n_layers));
  file.set_text("n_units", std::to_string(h.n_units));
  file.set_text("batch_size", std::to_string(h.batch_size));
  file.set_text("weight_decay", base::number(h.weight_decay));
  file.set_text("dropout", base::number(h.dropout));
  file.set_text("activation", std::string(model::name_of(h.activation)));
  file.set_text("validation_mse", base::number(validation_mse));
  return file;
}

Hyperparameters hyperparameters_of(const io::TensorFile& file) {
  Hyperparameters h;
  h.learning_rate = number_of(file, "learning_rate");
  h.n_layers = static_cast<int>(number_of(file, "n_layers"));
  h.n_units = static_cast<int>(number_of(file, "n_units"));
  h.batch_size = static_cast<int>(number_of(file, "batch_size"));
  h.weight_decay = number_of(file, "weight_decay");
  h.dropout = number_of(file, "dropout");
  h.activation = model::activation_of(file.text("activation"));
  return h;
}

}  // namespace elrom::networks
