#include "booster.hpp"

#include <xgboost/c_api.h>

#include <array>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"

namespace elrom::xgboost {
namespace {

void require(int status) {
  if (status != 0)
    throw SystemError(Problem{.what = "XGBoost refuses",
                              .found = XGBGetLastError(),
                              .expected = {},
                              .advice = "ELROM was tried with XGBoost 1.7"});
}

// Children beside each other and behind their parent, whatever XGBoost's numbers are; what it pruned away has no
// parent and stays behind.
void append(const nlohmann::json& tree, Booster::Flat& flat) {
  const auto left = tree.at("left_children").get<std::vector<int>>();
  const auto right = tree.at("right_children").get<std::vector<int>>();
  const auto feature = tree.at("split_indices").get<std::vector<int>>();
  const auto value = tree.at("split_conditions").get<std::vector<float>>();  // a leaf's: its value
  const auto root = static_cast<std::int32_t>(flat.nodes.size());
  flat.group.roots.push_back(root);
  flat.nodes.emplace_back();
  std::vector<std::size_t> open{0};  // XGBoost's number of each of our nodes
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto from = open[i];
    auto& node = flat.nodes[static_cast<std::size_t>(root) + i];
    if (left.at(from) < 0) {
      node = {.feature = -1, .left = 0, .value = value.at(from)};
      continue;
    }
    node = {.feature = feature.at(from),
            .left = static_cast<std::int32_t>(flat.nodes.size()),
            .value = value.at(from)};
    open.push_back(static_cast<std::size_t>(left[from]));
    open.push_back(static_cast<std::size_t>(right.at(from)));
    flat.nodes.insert(flat.nodes.end(), 2, {});
  }
}

}  // namespace

Matrix::Matrix(const particle::Table& inputs) : rows_(static_cast<std::size_t>(inputs.rows())) {
  using RowMajor = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const RowMajor values = inputs.cast<float>();
  if (values.size() == 0) throw InputError(Problem{.what = "no records to grow trees on"});
  if (!values.allFinite()) throw InputError(Problem{.what = "records with numbers that are not finite"});
  require(XGDMatrixCreateFromMat_omp(values.data(), static_cast<bst_ulong>(values.rows()),
                                     static_cast<bst_ulong>(values.cols()),
                                     std::numeric_limits<float>::quiet_NaN(), &handle_, 1));
}

Matrix::~Matrix() { XGDMatrixFree(handle_); }

void Matrix::set(const char* field, const Eigen::ArrayXd& values) {
  const Eigen::ArrayXf floats = values.cast<float>();
  check(static_cast<std::size_t>(floats.size()) == rows_, "xgboost: one value a record");
  if (!floats.allFinite()) throw InputError(Problem{.what = "records with numbers that are not finite"});
  require(XGDMatrixSetFloatInfo(handle_, field, floats.data(), static_cast<bst_ulong>(floats.size())));
}

Booster::Booster(const Matrix& train, const Matrix& watched,
                 const std::map<std::string, std::string>& parameters)
    : train_(train) {
  const std::array<DMatrixHandle, 2> matrices{train.handle(), watched.handle()};
  require(XGBoosterCreate(matrices.data(), matrices.size(), &handle_));
  try {
    for (const auto& [name, value] : parameters)
      require(XGBoosterSetParam(handle_, name.c_str(), value.c_str()));
  } catch (...) {
    XGBoosterFree(handle_);
    throw;
  }
}

Booster::~Booster() { XGBoosterFree(handle_); }

void Booster::grow(int round) { require(XGBoosterUpdateOneIter(handle_, round, train_.handle())); }

std::span<const float> Booster::predict(const Matrix& matrix) const {
  bst_ulong n = 0;
  const float* values = nullptr;
  require(XGBoosterPredict(handle_, matrix.handle(), 0, 0, 0, &n, &values));
  return {values, n};
}

Booster::Flat Booster::trees(int n_rounds) const {
  bst_ulong n = 0;
  const char* text = nullptr;
  require(XGBoosterSaveModelToBuffer(handle_, R"({"format": "json"})", &n, &text));
  const auto model = nlohmann::json::parse(text, text + n);
  const auto& learner = model.at("learner");
  const auto& trees = learner.at("gradient_booster").at("model").at("trees");
  check(static_cast<std::size_t>(n_rounds) <= trees.size(), "xgboost: as many trees as rounds");
  Flat flat;
  flat.group.base = std::stof(learner.at("learner_model_param").at("base_score").get<std::string>());
  for (std::size_t i = 0; i < static_cast<std::size_t>(n_rounds); ++i) append(trees[i], flat);
  return flat;
}

}  // namespace elrom::xgboost
