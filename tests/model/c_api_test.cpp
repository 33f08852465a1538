#include <gmock/gmock.h>

#include <string>
#include <thread>
#include <vector>

#include "elrom/model/elrom.h"
#include "elrom/model/prediction_file.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::model {
namespace {

using ::testing::HasSubstr;

class CApiTest : public ::testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const std::string path_ = (folder_ / "model.elrom").string();
  const std::vector<double> inputs_ = test::sample_case();
  void SetUp() override { test::sample_bundle().write(path_); }
};

TEST_F(CApiTest, PredictsWhatThePredictorPredicts) {
  const Predictor reference(path_);
  std::vector<float> expected(reference.size());
  Predictor::Scratch scratch;
  reference.predict(inputs_, expected, {}, scratch);

  elrom_predictor* predictor = elrom_open(path_.c_str(), nullptr);
  ASSERT_NE(predictor, nullptr) << elrom_last_error();
  std::vector<float> values(elrom_n_fields(predictor) * elrom_n_planes(predictor) *
                            elrom_n_columns(predictor));

  ASSERT_EQ(elrom_predict(predictor, inputs_.data(), values.data(), 2), 0) << elrom_last_error();
  EXPECT_EQ(values, expected);
  EXPECT_STREQ(elrom_field_name(predictor, 6), "pressure");
  EXPECT_STREQ(elrom_field_unit(predictor, 6), "Pa");
  EXPECT_STREQ(elrom_input_name(predictor, 1), "flow_1");
  EXPECT_EQ(elrom_input_name(predictor, 99), nullptr);
  elrom_close(predictor);
}

TEST_F(CApiTest, WritesTheFileThatACppCallerWrites) {
  Predictor reference(path_);
  const field::CaseInputs one{"case_a", 0.7, inputs_};
  const auto assessment = reference.guard().assess(inputs_);
  std::vector<float> values(reference.size());
  Predictor::Scratch scratch;
  reference.predict(inputs_, values, {}, scratch);
  const PredictionFrame frame(reference, Extent(reference.bundle()));
  write_prediction(frame, {.inputs = &one, .assessment = &assessment, .values = values, .half_width = {}},
                   folder_ / "cpp.hdf");

  elrom_predictor* predictor = elrom_open(path_.c_str(), nullptr);
  ASSERT_NE(predictor, nullptr) << elrom_last_error();
  const auto target = (folder_ / "c.hdf").string();
  ASSERT_EQ(elrom_write_prediction(predictor, inputs_.data(), "case_a", 0.7, target.c_str(), 1), 0)
      << elrom_last_error();
  EXPECT_EQ(test::read_bytes(folder_ / "c.hdf"), test::read_bytes(folder_ / "cpp.hdf"));

  EXPECT_EQ(elrom_write_prediction(predictor, inputs_.data(), nullptr, 0.7, target.c_str(), 1), 2);
  EXPECT_EQ(elrom_write_prediction(predictor, inputs_.data(), "a", 0.7, "/nowhere/a.hdf", 1), 1);
  EXPECT_THAT(elrom_last_error(), HasSubstr("/nowhere"));
  elrom_close(predictor);
}

TEST_F(CApiTest, MistakesGiveAStatusAndALine) {
  EXPECT_EQ(elrom_open("/nowhere/model.elrom", nullptr), nullptr);
  EXPECT_THAT(elrom_last_error(), HasSubstr("/nowhere/model.elrom"));
  EXPECT_EQ(elrom_open(nullptr, nullptr), nullptr);
  EXPECT_EQ(elrom_open(path_.c_str(), "presure"), nullptr);
  EXPECT_THAT(elrom_last_error(), HasSubstr("did you mean 'pressure'?"));

  elrom_predictor* predictor = elrom_open(path_.c_str(), "pressure");
  ASSERT_NE(predictor, nullptr);
  std::vector<float> values(60);
  EXPECT_EQ(elrom_predict(predictor, nullptr, values.data(), 1), 2);
  EXPECT_EQ(elrom_predict(predictor, inputs_.data(), values.data(), 0), 2);
  EXPECT_EQ(elrom_predict(nullptr, inputs_.data(), values.data(), 1), 2);
  elrom_close(predictor);
  elrom_close(nullptr);
  EXPECT_EQ(elrom_n_fields(nullptr), 0U);
}

TEST_F(CApiTest, ValidityIsCutToTheCallersRoom) {
  elrom_predictor* predictor = elrom_open(path_.c_str(), nullptr);
  std::vector<double> far = inputs_;
  far[0] *= 100;
  int verdict = -1;
  char reason[8];

  EXPECT_EQ(elrom_validity(predictor, far.data(), &verdict, reason, sizeof reason), 0);
  EXPECT_EQ(verdict, 2);
  EXPECT_STREQ(reason, "flow_0 ");
  elrom_close(predictor);
}

TEST_F(CApiTest, ManyThreadsShareOneHandle) {
  elrom_predictor* predictor = elrom_open(path_.c_str(), nullptr);
  std::vector<float> expected(9 * 60);
  ASSERT_EQ(elrom_predict(predictor, inputs_.data(), expected.data(), 1), 0);
  std::vector<int> equal(8, 0);

  {
    std::vector<std::jthread> threads;
    for (auto& flag : equal) {
      threads.emplace_back([&] {
        std::vector<float> values(9 * 60);
        for (int i = 0; i < 20; ++i) elrom_predict(predictor, inputs_.data(), values.data(), 1);
        flag = values == expected ? 1 : 0;
      });
    }
  }
  EXPECT_THAT(equal, ::testing::Each(1));
  elrom_close(predictor);
}

}  // namespace
}  // namespace elrom::model
