#include "elrom/networks/stage_files.hpp"

#include <gmock/gmock.h>

namespace elrom::networks {
namespace {

TEST(StageFiles, AScreeningReadsBackTheSame) {
  ScreeningResult screening;
  screening.error.setRandom(3, 4);
  screening.build_error.setRandom(2, 4);
  screening.mean_epochs = 1.0 / 3;

  const auto read = screening_of(to_file(screening));

  EXPECT_EQ(read.error, screening.error);
  EXPECT_EQ(read.build_error, screening.build_error);
  EXPECT_EQ(read.mean_epochs, screening.mean_epochs);
}

TEST(StageFiles, ATrainingThatDivergedHasNoNetwork) {
  TrainingResult result;
  result.validation_mse = 0.1 + 0.2;
  result.train_mse = 1.0 / 7;
  result.epochs = 9;
  result.diverged = true;

  const auto file = to_file(result);

  EXPECT_EQ(file.text("diverged"), "yes");
  EXPECT_EQ(file.text("epochs"), "9");
  EXPECT_EQ(std::stod(file.text("validation_mse")), result.validation_mse);
  EXPECT_EQ(std::stod(file.text("train_mse")), result.train_mse);
}

}  // namespace
}  // namespace elrom::networks
