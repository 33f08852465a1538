#include "elrom/repository/rules.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/model/prediction_file.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::repository {
namespace {

using Json = nlohmann::json;

const field::InputSchema schema({{.name = "primary_air", .unit = "kg/s", .display_unit = "t/h"},
                                 {.name = "diameter", .unit = "m", .display_unit = "um"}});

std::string one_case(const Json& inputs) {
  return Json{{"case", "a"}, {"load", 0.64}, {"inputs", inputs}}.dump();
}

TEST(JudgeInputs, TakesUnitsToSiInTheSchemasOrder) {
  const auto judged = judge_inputs(one_case({{"diameter [um]", 250}, {"primary_air [t/h]", 360}}), "scenario",
                                   &schema, nullptr);

  EXPECT_DOUBLE_EQ(judged.inputs.values[0], 100);
  EXPECT_DOUBLE_EQ(judged.inputs.values[1], 250e-6);
  EXPECT_DOUBLE_EQ(judged.inputs.load, 0.64);
  EXPECT_EQ(judged.document, R"({"diameter [m]":0.00025,"primary_air [kg/s]":100.0})");
  EXPECT_FALSE(judged.assessment);
}

TEST(JudgeInputs, StopsWhatNoFurnaceCanHave) {
  const auto judge = [](const Json& inputs) {
    return judge_inputs(one_case(inputs), "scenario", &schema, nullptr);
  };

  EXPECT_ERROR(InputError, "impossible primary_air in case a: found -3.6 t/h, expected 0 t/h",
               judge({{"primary_air [kg/s]", -1}, {"diameter [um]", 250}}));
  EXPECT_ERROR(InputError, "impossible diameter", judge({{"primary_air [kg/s]", 1}, {"diameter [um]", 0}}));
  EXPECT_ERROR(InputError, "impossible primary_air",
               judge({{"primary_air [kg/s]", 1e9}, {"diameter [um]", 250}}));
  EXPECT_ERROR(InputError, "wrong unit of 'diameter'",
               judge({{"primary_air [kg/s]", 1}, {"diameter [kg]", 250}}));
  EXPECT_ERROR(InputError, "missing boundary condition 'diameter", judge({{"primary_air [kg/s]", 1}}));
  EXPECT_ERROR(InputError, "did you mean 'primary_air'",
               judge({{"primary_ari [kg/s]", 1}, {"diameter [um]", 250}}));
  EXPECT_ERROR(InputError, "is no number", judge({{"primary_air [kg/s]", "much"}, {"diameter [um]", 250}}));
  EXPECT_ERROR(InputError, "is no number", judge({{"primary_air [kg/s]", nullptr}, {"diameter [um]", 250}}));
  EXPECT_ERROR(InputError, "unknown unit", judge({{"primary_air [furlong]", 1}, {"diameter [um]", 250}}));
}

TEST(JudgeInputs, WithoutAModelUnitsAndPhysicsStillCount) {
  EXPECT_EQ(judge_inputs(one_case({{"steam [t/h]", 36}}), "scenario", nullptr, nullptr).document,
            R"({"steam [kg/s]":10.0})");
  EXPECT_ERROR(InputError, "impossible steam",
               judge_inputs(one_case({{"steam [t/h]", -36}}), "scenario", nullptr, nullptr));
  EXPECT_ERROR(
      InputError, "appears twice",
      judge_inputs(one_case({{"steam [t/h]", 36}, {"steam [kg/s]", 10}}), "scenario", nullptr, nullptr));
}

TEST(JudgeInputs, TheGuardMarksWhatLiesOutside) {
  MatrixD inputs(12, 2);
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < 12; ++i) {
    inputs(i, 0) = 100 + static_cast<double>(i);
    inputs(i, 1) = 2e-4 + 1e-6 * static_cast<double>(i * i % 7);
    names.push_back("case" + std::to_string(i));
  }
  const model::Guard guard(schema, inputs, names, std::vector<double>(12, 1.0));

  const auto usual = judge_inputs(one_case({{"primary_air [kg/s]", 105}, {"diameter [um]", 202}}), "scenario",
                                  &schema, &guard);
  const auto far = judge_inputs(one_case({{"primary_air [kg/s]", 500}, {"diameter [um]", 202}}), "scenario",
                                &schema, &guard);

  EXPECT_EQ(usual.assessment->verdict, model::Verdict::inside);
  EXPECT_EQ(far.assessment->verdict, model::Verdict::outside);
  EXPECT_THAT(far.assessment->reason, ::testing::HasSubstr("primary_air"));
}

/// A prediction's file, as an upload would be.
struct SampleFile {
  test::TemporaryFolder folder;
  std::filesystem::path path = folder / "a.hdf";
  std::string mesh_digest;

  SampleFile() {
    const auto bundle = folder / "model.elrom";
    test::sample_bundle({}).write(bundle);
    const model::Predictor predictor(bundle);
    const model::PredictionFrame frame(predictor, model::Extent(predictor.bundle()));
    const field::CaseInputs inputs{"a", 1, std::vector<double>(predictor.bundle().info().schema.size(), 0.5)};
    std::vector<float> values(predictor.size());
    model::Predictor::Scratch scratch;
    predictor.predict(inputs.values, values, {}, scratch);
    const auto assessment = predictor.guard().assess(inputs.values);
    model::write_prediction(frame, {.inputs = &inputs, .assessment = &assessment, .values = values}, path);
    mesh_digest = predictor.bundle().mesh_digest();
  }
  void spoil(const std::string& field, float value) const {
    const auto file = io::Hdf5File::open(path, io::Hdf5File::Access::edit);
    const auto dataset = file.dataset("elrom/fields/" + field);
    auto values = dataset.read<float>();
    values[3] = value;
    dataset.write(std::span<const float>(values));
    file.flush();
  }
};

TEST(JudgeFields, PassesWhatAModelWrote) {
  const SampleFile sample;

  EXPECT_NO_THROW(judge_fields(sample.path, sample.mesh_digest));
  EXPECT_NO_THROW(judge_fields(sample.path, ""));
}

TEST(JudgeFields, StopsWhatNoFieldCanBe) {
  const SampleFile sample;

  EXPECT_ERROR(InputError, "fields on another mesh", judge_fields(sample.path, std::string(64, '0')));
  sample.spoil("solid_volume_fraction", -0.1F);
  EXPECT_ERROR(InputError, "impossible value in a.hdf, field solid_volume_fraction, value 3: found -0.1",
               judge_fields(sample.path, ""));
  sample.spoil("solid_volume_fraction", 1.1F);
  EXPECT_ERROR(InputError, "expected at most 0.65", judge_fields(sample.path, ""));
  sample.spoil("solid_volume_fraction", 0.1F);
  sample.spoil("pressure", std::nanf(""));
  EXPECT_ERROR(InputError, "no finite number", judge_fields(sample.path, ""));
}

TEST(JudgeFields, StopsWhatIsNoPrediction) {
  const test::TemporaryFolder folder;

  EXPECT_THROW(judge_fields(folder.write("a.hdf", "no HDF5"), ""), InputError);
  EXPECT_THROW(judge_fields(folder.write("b.hdf", ""), ""), InputError);
}

}  // namespace
}  // namespace elrom::repository
