#include "elrom/model/banded_networks.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "support/random_network.hpp"
#include "support/throws.hpp"

namespace elrom::model {
namespace {

using test::random_matrix;
using test::random_network;

constexpr std::size_t planes_each = 7, columns_each = 9, n_inputs = 4;

Submodel make_submodel(std::vector<std::int32_t> columns, std::size_t n_own, std::uint64_t seed,
                       std::size_t n_builds = 3) {
  Submodel submodel;
  submodel.name = "band " + std::to_string(seed);
  submodel.columns = std::move(columns);
  for (std::size_t b = 0; b < n_builds; ++b) {
    submodel.builds.push_back(random_network({n_inputs + n_own, 10, submodel.columns.size()},
                                             Activation::relu, base::Seed(seed).derive(b)));
    submodel.scores.push_back(b == 1 ? 0.1 : 0.2);
  }
  return submodel;
}

BandedNetworks::Parts make_parts(PlaneEncodingKind encoding = PlaneEncodingKind::fourier,
                                 TransformKind transform = TransformKind::none) {
  BandedNetworks::Parts parts;
  parts.n_columns = columns_each;
  parts.inputs = InputScaler::fit(random_matrix(12, n_inputs, base::Seed(1)).cast<double>());
  parts.planes = {encoding, planes_each, 3};
  parts.transform = {transform, 0.01F};
  parts.outputs =
      OutputScaler::fit(random_matrix(12, planes_each * columns_each, base::Seed(2)), columns_each, false);
  parts.submodels = {make_submodel({0, 2, 5, 6}, parts.planes.size(), 3),
                     make_submodel({1, 3, 4, 7, 8}, parts.planes.size(), 4)};
  return parts;
}

std::vector<std::int32_t> all_planes() {
  std::vector<std::int32_t> planes(planes_each);
  std::iota(planes.begin(), planes.end(), 0);
  return planes;
}

struct NetworkValues {
  std::vector<float> values, spread;
};
NetworkValues predict(const BandedNetworks& model, const std::vector<std::int32_t>& planes, bool best = false,
                      std::vector<double> inputs = {0.3, -0.2, 1.1, 0.7}) {
  NetworkValues result{std::vector<float>(planes.size() * columns_each),
                       std::vector<float>(planes.size() * columns_each)};
  Workspace workspace;
  model.predict({inputs, planes, best}, result.values, result.spread, workspace);
  return result;
}

// One build's value of one cell, from the definition.
float cell_value(const BandedNetworks::Parts& parts, const Submodel& submodel, std::size_t build,
                 std::size_t plane, std::size_t i_output, const std::vector<double>& inputs) {
  MatrixF x(1, static_cast<Eigen::Index>(n_inputs + parts.planes.size()));
  parts.inputs.apply(inputs, {x.data(), n_inputs});
  parts.planes.encode(plane, {x.data() + n_inputs, parts.planes.size()});
  MatrixF y(1, static_cast<Eigen::Index>(submodel.columns.size()));
  Workspace workspace;
  submodel.builds[build].forward(x, y, workspace);
  const auto column = static_cast<Eigen::Index>(submodel.columns[i_output]);
  const auto row = parts.outputs.row(plane);
  return parts.transform.undo(parts.outputs.mean(row, column) +
                              parts.outputs.deviation(row, column) *
                                  y(0, static_cast<Eigen::Index>(i_output)));
}

TEST(BandedNetworks, MeanAndSpreadAreTakenOverTheBuildsInPhysicalUnits) {
  const auto parts = make_parts(PlaneEncodingKind::fourier, TransformKind::asinh);
  const BandedNetworks model(parts);
  const std::vector<double> inputs{0.3, -0.2, 1.1, 0.7};

  const auto result = predict(model, all_planes());

  for (const auto& submodel : parts.submodels)
    for (std::size_t j = 0; j < submodel.columns.size(); ++j) {
      double sum = 0, squares = 0;
      for (std::size_t b = 0; b < 3; ++b) sum += double{cell_value(parts, submodel, b, 5, j, inputs)};
      for (std::size_t b = 0; b < 3; ++b)
        squares += std::pow(double{cell_value(parts, submodel, b, 5, j, inputs)} - sum / 3, 2);
      const std::size_t cell = 5 * columns_each + static_cast<std::size_t>(submodel.columns[j]);
      EXPECT_NEAR(double{result.values[cell]}, sum / 3, 1e-5 * (1 + std::abs(sum)));
      EXPECT_NEAR(double{result.spread[cell]}, std::sqrt(squares / 2), 1e-5 * (1 + std::sqrt(squares)));
    }
}

TEST(BandedNetworks, TheBestBuildIsTheOneOfTheLowestScore) {
  const auto parts = make_parts();
  const BandedNetworks model(parts);

  const auto result = predict(model, {2}, true);

  const auto& submodel = parts.submodels[1];
  EXPECT_EQ(submodel.best(), 1U);
  EXPECT_FLOAT_EQ(result.values[3], cell_value(parts, submodel, 1, 2, 1, {0.3, -0.2, 1.1, 0.7}));
  EXPECT_THAT(result.spread, ::testing::Each(0.0F));
}

class Encodings : public ::testing::TestWithParam<PlaneEncodingKind> {};

TEST_P(Encodings, APlanesBitsDoNotDependOnTheOtherPlanes) {
  const BandedNetworks model(make_parts(GetParam()));
  const auto all = predict(model, all_planes());

  for (std::int32_t plane = 0; plane < static_cast<std::int32_t>(planes_each); ++plane) {
    const auto one = predict(model, {plane});
    const auto first = static_cast<std::ptrdiff_t>(plane) * static_cast<std::ptrdiff_t>(columns_each);
    EXPECT_TRUE(std::equal(one.values.begin(), one.values.end(), all.values.begin() + first));
    EXPECT_TRUE(std::equal(one.spread.begin(), one.spread.end(), all.spread.begin() + first));
  }
}

TEST_P(Encodings, ReadsBackWhatItSaved) {
  const BandedNetworks model(make_parts(GetParam(), TransformKind::log));
  io::TensorFile file;

  model.save(file, "model/pressure");
  const auto loaded = load_field_model(file, "model/pressure");

  const auto before = predict(model, all_planes());
  EXPECT_EQ(before.values, predict(dynamic_cast<const BandedNetworks&>(*loaded), all_planes()).values);
}

INSTANTIATE_TEST_SUITE_P(AllEncodings, Encodings,
                         ::testing::Values(PlaneEncodingKind::index, PlaneEncodingKind::fourier,
                                           PlaneEncodingKind::one_hot),
                         [](const auto& test) { return std::string(name_of(test.param)); });

TEST(BandedNetworks, MasksShareThePlanesOfAColumnOut) {
  auto parts = make_parts();
  parts.submodels[0].columns = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  parts.submodels[0] = make_submodel(parts.submodels[0].columns, parts.planes.size(), 3);
  parts.submodels[1] = make_submodel(parts.submodels[0].columns, parts.planes.size(), 4);
  parts.submodels[0].mask.assign(planes_each * columns_each, 0);
  std::fill_n(parts.submodels[0].mask.begin(), 3 * columns_each + 4, 1);
  parts.submodels[1].mask = parts.submodels[0].mask;
  for (auto& bit : parts.submodels[1].mask) bit = bit == 0 ? 1 : 0;
  const BandedNetworks model(parts);
  const std::vector<double> inputs{0.3, -0.2, 1.1, 0.7};

  const auto result = predict(model, all_planes(), true);

  EXPECT_FLOAT_EQ(result.values[3 * columns_each + 3],
                  cell_value(parts, parts.submodels[0], 1, 3, 3, inputs));
  EXPECT_FLOAT_EQ(result.values[3 * columns_each + 4],
                  cell_value(parts, parts.submodels[1], 1, 3, 4, inputs));

  // Of planes that one submodel answers for, the other is not even read.
  io::TensorFile file;
  model.save(file, "m");
  const auto some = BandedNetworks::load(file, "m", {.planes = {0, 2}});
  const auto& loaded = dynamic_cast<const BandedNetworks&>(*some);
  EXPECT_EQ(loaded.parts().submodels.size(), 1U);
  EXPECT_EQ(predict(loaded, {0, 2}).values, predict(model, {0, 2}).values);
}

TEST(BandedNetworks, RefusesACellThatNobodyAnswersFor) {
  auto parts = make_parts();
  parts.submodels.pop_back();

  try {
    const BandedNetworks model(std::move(parts));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("plane 0, column 1"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("0 submodels"));
  }
}

TEST(BandedNetworks, RefusesACellThatTwoMasksCover) {
  auto parts = make_parts();
  parts.submodels[0] = make_submodel({0, 1, 2, 3, 4, 5, 6, 7, 8}, parts.planes.size(), 3);
  parts.submodels[1] = make_submodel(parts.submodels[0].columns, parts.planes.size(), 4);
  parts.submodels[0].mask.assign(planes_each * columns_each, 1);
  parts.submodels[1].mask.assign(planes_each * columns_each, 0);
  EXPECT_NO_THROW(BandedNetworks{parts});
  parts.submodels[1].mask[4 * columns_each + 7] = 1;

  EXPECT_ERROR(InputError, "plane 4, column 7: found 2 submodels", BandedNetworks(parts));
  parts.submodels[0].mask[4 * columns_each + 7] = parts.submodels[1].mask[4 * columns_each + 7] = 0;
  EXPECT_ERROR(InputError, "plane 4, column 7: found 0 submodels", BandedNetworks(parts));
}

// A file of a few bytes may speak of any number of planes.
TEST(BandedNetworks, RefusesMorePlanesThanAnyFurnaceHas) {
  auto parts = make_parts(PlaneEncodingKind::fourier);
  parts.planes.n_planes = 10'000'000;

  EXPECT_ERROR(InputError, "plane encoding: found 10000000 planes", BandedNetworks(parts));
}

TEST(BandedNetworks, FarOutsideTheFieldsStayFiniteAndBounded) {
  const BandedNetworks model(make_parts(PlaneEncodingKind::index, TransformKind::log));

  const auto far = predict(model, all_planes(), false, {1e6, -1e6, 1e6, 1e6});
  const auto farther = predict(model, all_planes(), false, {1e30, -1e30, 1e30, 1e30});

  EXPECT_EQ(far.values, farther.values);
  for (const float value : far.values) EXPECT_TRUE(std::isfinite(value));
}

TEST(InputScaler, AnInputThatWasConstantHasNoInfluence) {
  MatrixD inputs(3, 2);
  inputs << 1, 300, 2, 300, 3, 300;
  const auto scaler = InputScaler::fit(inputs);
  std::vector<float> scaled(2);

  scaler.apply(std::vector<double>{3, 900}, scaled);

  EXPECT_FLOAT_EQ(scaled[0], 1 / std::sqrt(2.0F / 3));  // (3 - 2) / standard deviation of 1, 2, 3
  EXPECT_EQ(scaled[1], 0);
}

TEST(OutputScaler, PerColumnPoolsThePlanesAndPerCellDoesNot) {
  MatrixF values(2, 4);  // two planes of two columns; column 1 is constant
  values << 1, 5, 3, 5, 3, 5, 5, 5;

  const auto column = OutputScaler::fit(values, 2, false), cell = OutputScaler::fit(values, 2, true);

  EXPECT_FLOAT_EQ(column.mean(0, 0), 3);
  EXPECT_FLOAT_EQ(column.deviation(0, 0), std::sqrt(2.0F));
  EXPECT_EQ(column.deviation(0, 1), 0);
  EXPECT_FLOAT_EQ(cell.mean(1, 0), 4);
  EXPECT_FLOAT_EQ(cell.deviation(1, 0), 1);
}

TEST(TargetTransform, UndoIsTheInverse) {
  for (const auto kind : {TransformKind::none, TransformKind::log, TransformKind::asinh}) {
    const TargetTransform transform{kind, 1e-3F};
    for (const float y : {0.0F, 1e-5F, 0.02F, 0.6F, 40.0F})
      EXPECT_NEAR(transform.undo(transform.apply(y)), y, 2e-6F * (1 + 10 * y)) << name_of(kind);
  }
}

TEST(TargetTransform, ScaleIsTheTenthOfTheSizesThatAreNotZero) {
  std::vector<float> values(100, 0.0F);
  for (int i = 1; i <= 50; ++i) values[static_cast<std::size_t>(i)] = -static_cast<float>(i);

  EXPECT_FLOAT_EQ(TargetTransform::fit(TransformKind::asinh, values).scale, 6);
}

TEST(PlaneEncoding, FourierHoldsTheIndexAndItsWaves) {
  const PlaneEncoding encoding{PlaneEncodingKind::fourier, 4, 1};
  std::vector<float> inputs(encoding.size());

  encoding.encode(1, inputs);

  const float t = 1.5F / 4;
  EXPECT_THAT(inputs, ::testing::ElementsAre(::testing::FloatNear(-0.5F / std::sqrt(1.25F), 1e-6F),
                                             ::testing::FloatNear(std::sin(3.14159265F * t), 1e-6F),
                                             ::testing::FloatNear(std::cos(3.14159265F * t), 1e-6F)));
}

}  // namespace
}  // namespace elrom::model
