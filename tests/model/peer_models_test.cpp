// Every closed-form model: the same after save and load, and
// plane by plane independent of what else is asked.

#include <gtest/gtest.h>

#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "elrom/model/coefficient_models.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/model/nearest_model.hpp"
#include "elrom/model/pod_model.hpp"
#include "support/throws.hpp"

namespace elrom::model {
namespace {

constexpr std::size_t n_planes = 5, n_columns = 7, n_cases = 9, n_modes = 6;

MatrixD random_matrix(Eigen::Index rows, Eigen::Index columns, std::string_view name) {
  base::Random random(base::Seed(31).derive(name));
  MatrixD values(rows, columns);
  for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = random.normal();
  return values;
}

struct Parts {
  MatrixD x = random_matrix(n_cases, 3, "x");
  Eigen::MatrixXd y = random_matrix(n_cases, n_modes, "y");
  math::Standardiser scaler{x};
  MatrixD z = scaler.apply(x);
  Eigen::VectorXd ones = Eigen::VectorXd::Ones(n_modes);
};

std::shared_ptr<CoefficientModel> coefficients(const std::string& kind) {
  const Parts p;
  const math::GpParameters gp{Eigen::Vector3d(1, 2, 3), 1.5, 0.1, math::Covariance::matern52};
  if (kind == "linear")
    return std::make_shared<LinearCoefficients>(p.scaler, random_matrix(3, n_modes, "w"), p.ones, p.ones);
  if (kind == "pod_gp") {
    return std::make_shared<GpCoefficients>(p.scaler, p.z, std::vector{math::GaussianProcess(p.z, p.y, gp)},
                                            2 * p.ones);
  }
  if (kind == "pod_gp_per_mode") {
    std::vector<math::GaussianProcess> processes;
    for (Eigen::Index m = 0; m < p.y.cols(); ++m) processes.emplace_back(p.z, p.y.col(m), gp);
    return std::make_shared<GpCoefficients>(p.scaler, p.z, processes, 2 * p.ones);
  }
  return std::make_shared<RbfCoefficients>(p.scaler, math::RbfInterpolator(p.z, p.y, {.smoothing = 0.1}),
                                           p.ones);
}

std::vector<double> column_weights() {
  std::vector<double> weights(n_columns);
  for (std::size_t c = 0; c < n_columns; ++c) weights[c] = 0.5 - 0.1 * static_cast<double>(c);
  return weights;
}

/// log(2) + the second input.
FeatureMap a_logarithm() {
  return FeatureMap({{"scale", {{FeatureTerm::Kind::value, 1, {{1}, {1.0}, std::log(2.0)}, {}, 0}}}}, 3);
}

/// Columns are exchanged with those of the other side; inputs 0 and 1 change places.
field::Mirror swap_mirror(std::size_t planes) {
  field::Mirror mirror{.name = "swap",
                       .axes = "y",
                       .input_from = {1, 0, 2},
                       .input_sign = {1, 1, 1},
                       .input_offset = {0, 0, 0}};
  for (std::size_t c = 0; c < planes * n_columns; ++c) {
    mirror.cell_from.push_back(
        static_cast<std::int32_t>(c / n_columns * n_columns + (n_columns - 1 - c % n_columns)));
  }
  return mirror;
}

SymmetryFold swap_fold() {
  return {{swap_mirror(n_planes)}, field::Parity::vector_y, {{1}}, n_planes, n_columns};
}

/// The mean of the inputs that change places, twice, and the third input.
FeatureMap symmetric_inputs() {
  const LinearForm mean{{0, 1}, {0.5, 0.5}, 0};
  return FeatureMap({{"a", {{.form = mean}}}, {"b", {{.form = mean}}}, {"c", {{.form = {{2}, {1.0}, 0}}}}},
                    3);
}

std::shared_ptr<FieldModel> pod_of(const std::string& kind, std::size_t columns) {
  const Eigen::VectorXd mean = random_matrix(static_cast<Eigen::Index>(n_planes * columns), 1, "mean");
  const MatrixF modes = random_matrix(n_modes, mean.size(), "modes").cast<float>();
  return make_pod_model(kind, mean, modes, mean.cwiseAbs(), columns, coefficients(kind));
}

std::shared_ptr<FieldModel> make(const std::string& kind) {
  if (kind == "nearest") {
    const Parts p;
    const MatrixF values = random_matrix(n_cases, n_planes * n_columns, "values").cast<float>();
    return std::make_shared<NearestModel>(p.scaler, p.z, io::Tensor::copy(values), n_columns);
  }
  if (kind == "blend") {
    return std::make_shared<BlendModel>(
        std::vector<BlendModel::Member>{{{0.25}, make("linear")}, {{0.75}, make("pod_rbf")}});
  }
  if (kind == "blend_by_column") {
    return std::make_shared<BlendModel>(
        std::vector<BlendModel::Member>{{column_weights(), make("linear")}, {{0.75}, make("pod_rbf")}});
  }
  if (kind == "scaled") return std::make_shared<ScaledModel>(a_logarithm(), make("pod_gp"));
  if (kind == "unfolded") {
    return std::make_shared<UnfoldedModel>(symmetric_inputs(), swap_fold(),
                                           pod_of("pod_gp", swap_fold().n_orbits()), make("linear"));
  }
  if (kind == "unfolded_whole")
    return std::make_shared<UnfoldedModel>(symmetric_inputs(), SymmetryFold(), make("pod_gp"), nullptr);
  return pod_of(kind, n_columns);
}

struct Answer {
  std::vector<float> values, spread;
  bool operator==(const Answer&) const = default;
};

Answer ask(const FieldModel& model, const std::vector<std::int32_t>& planes,
           const std::vector<double>& inputs = {0.3, -0.7, 0.2}) {
  Answer answer{std::vector<float>(planes.size() * n_columns), std::vector<float>(planes.size() * n_columns)};
  Workspace workspace;
  model.predict({.inputs = inputs, .planes = planes}, answer.values, answer.spread, workspace);
  return answer;
}

const std::vector<std::int32_t> every_plane{0, 1, 2, 3, 4};

class EveryModel : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Peers, EveryModel,
                         ::testing::Values("nearest", "linear", "pod_gp", "pod_gp_per_mode", "pod_rbf",
                                           "blend", "blend_by_column", "scaled", "unfolded",
                                           "unfolded_whole"));

TEST_P(EveryModel, IsTheSameAfterSaveAndLoad) {
  const auto model = make(GetParam());
  io::TensorFile file;

  model->save(file, "fields/pressure");
  const auto loaded = load_field_model(file, "fields/pressure");

  EXPECT_EQ(loaded->kind(), model->kind());
  EXPECT_EQ(ask(*loaded, every_plane), ask(*model, every_plane));
}

TEST_P(EveryModel, PlanesDoNotDependOnEachOther) {
  const auto model = make(GetParam());
  const Answer all = ask(*model, every_plane), two = ask(*model, {1, 4});

  for (std::size_t c = 0; c < n_columns; ++c) {
    EXPECT_EQ(two.values[c], all.values[n_columns + c]);
    EXPECT_EQ(two.values[n_columns + c], all.values[4 * n_columns + c]);
    EXPECT_EQ(two.spread[n_columns + c], all.spread[4 * n_columns + c]);
  }
}

TEST_P(EveryModel, NamesTheMissingTensor) {
  io::TensorFile whole, part;
  make(GetParam())->save(whole, "m");
  for (const auto& [key, text] : whole.texts()) part.set_text(key, text);  // descriptions without tensors

  EXPECT_THROW((void)load_field_model(part, "m"), InputError);
}

// A fuzzer found empty weights that let any number of intercepts pass.
TEST_P(EveryModel, RefusesAnEmptyTensor) {
  io::TensorFile whole;
  make(GetParam())->save(whole, "m");
  for (const auto& [name, tensor] : whole.tensors()) {
    for (std::size_t i = 0; i < tensor.shape().size(); ++i) {
      auto shape = tensor.shape();
      shape[i] = 0;
      auto file = whole;
      file.set(name, io::Tensor(tensor.type(), shape, nullptr, tensor.bytes().data()));
      EXPECT_THROW((void)load_field_model(file, "m"), InputError) << name << ", dimension " << i;
    }
  }
}

TEST(PodModel, IsMeanPlusCoefficientsTimesModes) {
  const auto model = make("linear");
  const Parts p;
  std::vector<double> scaled(3), c(n_modes);
  Workspace workspace;
  coefficients("linear")->predict(std::vector<double>{0.3, -0.7, 0.2}, c, {}, false, workspace);
  const Eigen::VectorXd mean = random_matrix(n_planes * n_columns, 1, "mean");
  const MatrixD modes = random_matrix(n_modes, n_planes * n_columns, "modes");

  const Eigen::VectorXd expected = mean + modes.transpose() * Eigen::VectorXd::Map(c.data(), n_modes);

  const Answer answer = ask(*model, every_plane);
  for (Eigen::Index i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(answer.values[static_cast<std::size_t>(i)], expected[i], 1e-5 * expected.norm());
  }
}

TEST(PodModel, SpreadAddsModeVarianceToTheResidual) {
  const auto model = make("linear");  // unit variance of every coefficient
  const Eigen::VectorXd mean = random_matrix(n_planes * n_columns, 1, "mean");
  const MatrixD modes = random_matrix(n_modes, n_planes * n_columns, "modes");

  const Answer answer = ask(*model, every_plane);

  EXPECT_NEAR(answer.spread[3], std::sqrt(modes.col(3).squaredNorm() + mean[3] * mean[3]), 1e-5);
}

/// Modes that are zero outside some planes, and where they are not.
struct ModesOfSomePlanes {
  MatrixF modes = random_matrix(n_modes, n_planes* n_columns, "modes").cast<float>();
  std::vector<ModePlanes> planes{{0, 5}, {0, 2}, {1, 3}, {4, 1}, {2, 2}, {0, 3}};
  ModesOfSomePlanes() {
    for (std::size_t m = 0; m < n_modes; ++m) {
      auto mode = modes.row(static_cast<Eigen::Index>(m));
      mode.head(static_cast<Eigen::Index>(planes[m].first * n_columns)).setZero();
      mode.tail(static_cast<Eigen::Index>((n_planes - planes[m].first - planes[m].n) * n_columns)).setZero();
    }
  }
  [[nodiscard]] std::unique_ptr<PodModel> model(bool everywhere) const {
    const Eigen::VectorXd mean = random_matrix(n_planes * n_columns, 1, "mean");
    return make_pod_model("linear", mean, modes, mean.cwiseAbs(), n_columns, coefficients("linear"), {}, {},
                          everywhere ? std::vector<ModePlanes>{} : planes);
  }
};

TEST(PodModel, ModesThatAreZeroInAPlaneAreNotStoredThere) {
  const ModesOfSomePlanes some;
  io::TensorFile file;

  const auto whole = some.model(true), short_one = some.model(false);
  short_one->save(file, "m");
  const auto loaded = load_field_model(file, "m");

  const Answer expected = ask(*whole, every_plane), found = ask(*loaded, every_plane);
  for (std::size_t c = 0; c < n_planes * n_columns; ++c) {
    EXPECT_NEAR(found.values[c], expected.values[c], 1e-5);
    EXPECT_NEAR(found.spread[c], expected.spread[c], 1e-5);
  }
  EXPECT_EQ(found, ask(*short_one, every_plane));
  EXPECT_EQ(file.tensor("m/modes", std::array<std::size_t, 2>{io::any_size, io::any_size}).shape()[0], 16U);
}

TEST(PodModel, RefusesRowsThatDoNotFit) {
  const auto with = [](std::vector<std::int32_t> first_row, std::vector<std::int32_t> mode_of) {
    PodModel::Parts parts{.kind = "linear", .coefficients = coefficients("linear")};
    parts.mean = io::Tensor::copy(MatrixF(MatrixF::Zero(2, 3)));
    parts.modes = io::Tensor::copy(MatrixF(MatrixF::Zero(3, 3)));
    parts.first_row = std::move(first_row);
    parts.mode_of = std::move(mode_of);
    return PodModel(parts, "file:m");
  };
  const std::string message = "rows of modes do not fit mean and coefficients";

  EXPECT_NO_THROW(with({0, 2, 3}, {0, 5, 1}));
  EXPECT_ERROR(InputError, message, with({0, 3}, {0, 5, 1}));        // one plane
  EXPECT_ERROR(InputError, message, with({1, 2, 3}, {0, 5, 1}));     // does not begin at the first row
  EXPECT_ERROR(InputError, message, with({0, 2, 4}, {0, 5, 1}));     // ends behind the last
  EXPECT_ERROR(InputError, message, with({0, 4, 3}, {0, 5, 1}));     // backwards
  EXPECT_ERROR(InputError, message, with({0, 2, 3}, {0, 6, 1}));     // six modes: 0 to 5
  EXPECT_ERROR(InputError, message, with({0, 2, 3}, {0, -1, 1}));    // no mode
  EXPECT_ERROR(InputError, message, with({0, 2, 4}, {0, 5, 1, 2}));  // three rows are there
}

TEST(PodModel, RefusesModesOfAnotherSize) {
  PodModel::Parts parts{.kind = "linear", .coefficients = coefficients("linear")};
  parts.mean = io::Tensor::copy(MatrixF(MatrixF::Zero(2, 3)));
  parts.modes =
      io::Tensor::copy(std::vector<float>(2 * 5 * 3), {2, 5, 3});  // five modes for six coefficients

  EXPECT_ERROR(InputError, "found 2 x 5 x 3, expected 2 x 6 x 3", PodModel(parts, "file:m"));
}

TEST(GpCoefficients, AgreeWithTheProcess) {
  const Parts p;
  const math::GpParameters gp{Eigen::Vector3d(1, 2, 3), 1.5, 0.1, math::Covariance::matern52};
  const math::GaussianProcess process(p.z, p.y, gp);
  std::vector<double> c(n_modes), variance(n_modes);
  const std::vector<double> inputs{0.3, -0.7, 0.2};
  MatrixD at(1, 3);
  p.scaler.apply(inputs, std::span(at.data(), 3));
  Workspace workspace;

  coefficients("pod_gp")->predict(inputs, c, variance, false, workspace);

  EXPECT_NEAR(c[2], 2 * process.mean(at)(0, 2), 1e-12);
  EXPECT_NEAR(variance[2], 4 * process.variance(at)[0], 1e-5);  // the factor is stored in float32
}

TEST(NearestModel, AnswersWithTheNearestCase) {
  const auto model = make("nearest");
  const MatrixD x = random_matrix(n_cases, 3, "x");
  const MatrixF values = random_matrix(n_cases, n_planes * n_columns, "values").cast<float>();

  const Answer answer = ask(*model, every_plane, {x(4, 0) + 1e-3, x(4, 1), x(4, 2)});

  EXPECT_EQ(answer.values[10], values(4, 10));
}

TEST(BlendModel, IsTheWeightedSum) {
  const Answer blend = ask(*make("blend"), every_plane), a = ask(*make("linear"), every_plane),
               b = ask(*make("pod_rbf"), every_plane);

  for (std::size_t i = 0; i < a.values.size(); ++i) {
    EXPECT_NEAR(blend.values[i], 0.25 * a.values[i] + 0.75 * b.values[i], 1e-5);
    EXPECT_NEAR(blend.spread[i], 0.25 * a.spread[i] + 0.75 * b.spread[i], 1e-5);
  }
}

TEST(BlendModel, WeighsEveryColumnByItself) {
  const Answer blend = ask(*make("blend_by_column"), every_plane), a = ask(*make("linear"), every_plane),
               b = ask(*make("pod_rbf"), every_plane);
  const auto weights = column_weights();

  for (std::size_t i = 0; i < a.values.size(); ++i) {
    const double weight = weights[i % n_columns];
    EXPECT_NEAR(blend.values[i], weight * a.values[i] + 0.75 * b.values[i], 1e-5);
    EXPECT_NEAR(blend.spread[i], std::abs(weight) * a.spread[i] + 0.75 * b.spread[i], 1e-5);
  }
}

TEST(BlendModel, RefusesWeightsForOtherColumns) {
  EXPECT_ERROR(InputError, "one a column",
               BlendModel({{std::vector<double>(n_columns + 1, 0.5), make("linear")}}));
  EXPECT_ERROR(InputError, "one a column", BlendModel({{{}, make("linear")}}));
  io::TensorFile file;
  make("blend_by_column")->save(file, "m");
  file.set("m/weights", io::Tensor::copy(std::span<const double>(std::vector<double>(6, 0.5)), {2, 3}));
  EXPECT_ERROR(InputError, "one a column", load_field_model(file, "m"));
}

TEST(ScaledModel, IsTheModelTimesTheScaleOfTheInputs) {
  const std::vector<double> inputs{0.3, -0.7, 0.2};
  const Answer scaled = ask(*make("scaled"), every_plane, inputs),
               own = ask(*make("pod_gp"), every_plane, inputs);
  const double scale = 2 * std::exp(-0.7);

  for (std::size_t i = 0; i < own.values.size(); ++i) {
    EXPECT_NEAR(scaled.values[i], scale * own.values[i], 1e-5);
    EXPECT_NEAR(scaled.spread[i], scale * own.spread[i], 1e-5);
  }
  EXPECT_EQ(make("scaled")->kind(), "pod_gp");
  EXPECT_EQ(scale_of(*make("scaled")), "scale");
  EXPECT_EQ(scale_of(BlendModel({{{0.5}, make("linear")}, {{0.5}, make("scaled")}})), "scale");
  EXPECT_EQ(scale_of(*make("blend")), "");
}

TEST(ScaledModel, RefusesAScaleThatIsNotOneFeatureOfTheSameInputs) {
  EXPECT_ERROR(InputError, "found 0 features of 3 inputs, expected one of 3 inputs",
               ScaledModel(FeatureMap({}, 3), make("linear")));
  EXPECT_ERROR(InputError, "found 1 features of 4 inputs",
               ScaledModel(FeatureMap({{"one", {}}}, 4), make("linear")));
}

TEST(UnfoldedModel, IsItsOrbitsModelAskedWithSymmetricInputsAndTheAsymmetry) {
  const std::vector<double> inputs{0.3, -0.7, 0.2}, symmetric{-0.2, -0.2, 0.2};
  const Answer whole = ask(*make("unfolded"), every_plane, inputs),
               asymmetry = ask(*make("linear"), every_plane, inputs);
  const auto own = pod_of("pod_gp", 4);
  std::vector<float> values(n_planes * 4), spread(values.size());
  Workspace workspace;
  own->predict({.inputs = symmetric, .planes = every_plane}, values, spread, workspace);

  for (std::size_t plane = 0; plane < n_planes; ++plane)
    for (std::size_t c = 0; c < n_columns; ++c) {
      // The velocity normal to the mirror changes its sign on the other side; on the mirror it is none.
      const float sign = c < 3 ? 1.0F : c == 3 ? 0.0F : -1.0F;
      const std::size_t at = plane * n_columns + c, orbit = plane * 4 + std::min(c, 6 - c);
      EXPECT_NEAR(whole.values[at], sign * values[orbit] + asymmetry.values[at], 1e-5);
      EXPECT_NEAR(whole.spread[at], sign * sign * spread[orbit] + asymmetry.spread[at], 1e-5);
    }
  EXPECT_EQ(make("unfolded")->kind(), "pod_gp");
}

TEST(UnfoldedModel, WithoutAFoldItsModelHasAllColumns) {
  EXPECT_EQ(ask(*make("unfolded_whole"), every_plane, {0.3, -0.7, 0.2}),
            ask(*make("pod_gp"), every_plane, {-0.2, -0.2, 0.2}));
  EXPECT_EQ(scale_of(UnfoldedModel(symmetric_inputs(), {}, make("scaled"), nullptr)), "scale");
}

TEST(UnfoldedModel, RefusesPartsThatDoNotFit) {
  EXPECT_ERROR(InputError, "4 orbits of columns, expected 3 and 7",
               UnfoldedModel(symmetric_inputs(), swap_fold(), make("pod_gp"), nullptr));
  EXPECT_ERROR(InputError, "found 0 inputs", UnfoldedModel(FeatureMap({}, 3), {}, make("pod_gp"), nullptr));
  EXPECT_ERROR(InputError, "found 3 inputs, 5 planes, 4 columns, expected 3 inputs, 5 planes, 7 columns",
               UnfoldedModel(symmetric_inputs(), {}, make("pod_gp"), pod_of("linear", 4)));
  io::TensorFile file;
  make("unfolded")->save(file, "m");
  file.set_text("m", R"({"kind": "unfolded", "asymmetry": 1})");
  EXPECT_ERROR(InputError, "true or false", load_field_model(file, "m"));
}

TEST(BlendModel, RefusesAnAbsurdNumberOfParts) {
  io::TensorFile file;
  file.set_text("m", R"({"kind": "blend", "parts": 4000000000})");

  EXPECT_ERROR(InputError, "between 1 and 64", load_field_model(file, "m"));
}

TEST(MirrorModel, GivesMirroredCasesMirroredFields) {
  const auto group = field::symmetry_group({swap_mirror(n_planes)}, 3, n_planes * n_columns);
  const MirrorModel model(make("pod_gp"), group, field::Parity::vector_y, n_planes);

  const Answer one = ask(model, every_plane, {0.3, -0.7, 0.2}),
               other = ask(model, every_plane, {-0.7, 0.3, 0.2});

  for (std::size_t c = 0; c < n_columns; ++c) {
    EXPECT_NEAR(one.values[c], -other.values[n_columns - 1 - c],
                1e-6);  // the normal component changes its sign
  }
}

TEST(MirrorModel, IsTheSameAfterSaveAndLoad) {
  const auto group = field::symmetry_group({swap_mirror(n_planes)}, 3, n_planes * n_columns);
  const MirrorModel model(make("pod_gp"), group, field::Parity::scalar, n_planes);
  io::TensorFile file;

  model.save(file, "m");

  EXPECT_EQ(ask(*load_field_model(file, "m"), every_plane), ask(model, every_plane));
  EXPECT_EQ(file.tensor("m/image1/column_from").shape()[0], 1U);  // one map for all planes
}

TEST(MirrorModel, RefusesMapsOfOtherPlanesOrInputs) {
  const auto group = field::symmetry_group({swap_mirror(n_planes)}, 3, n_planes * n_columns);
  io::TensorFile file;
  MirrorModel(make("pod_gp"), group, field::Parity::scalar, n_planes).save(file, "m");
  const std::vector<std::int32_t> zeros(2 * n_columns, 0);
  auto few_planes = file, few_inputs = file;
  few_planes.set("m/image1/column_from",
                 io::Tensor::copy(std::span<const std::int32_t>(zeros), {2, n_columns}));
  few_inputs.set("m/image0/input_from", io::Tensor::copy(std::span<const std::int32_t>(zeros).first(2), {2}));

  EXPECT_ERROR(InputError, "image1", load_field_model(few_planes, "m"));
  EXPECT_ERROR(InputError, "image0/input_from", load_field_model(few_inputs, "m"));
}

}  // namespace
}  // namespace elrom::model
