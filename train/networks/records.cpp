#include "elrom/networks/records.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/math/gaussian_process.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/ridge.hpp"
#include "elrom/math/standardiser.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::networks {
namespace {

constexpr double least_relevance = 0.1;
constexpr Eigen::Index n_components = 10;

MatrixF transformed_rows(const field::FieldRows& data, std::span<const std::size_t> cases,
                         const model::TargetTransform& transform) {
  MatrixF values(static_cast<Eigen::Index>(cases.size()),
                 static_cast<Eigen::Index>(data.n_planes() * data.n_columns()));
  for (std::size_t i = 0; i < cases.size(); ++i)
    std::ranges::transform(data.values(cases[i]), values.row(static_cast<Eigen::Index>(i)).data(),
                           [&](float y) { return transform.apply(y); });
  return values;
}

MatrixD input_rows(const field::FieldRows& data, std::span<const std::size_t> cases) {
  MatrixD inputs(static_cast<Eigen::Index>(cases.size()), static_cast<Eigen::Index>(data.n_inputs()));
  for (std::size_t i = 0; i < cases.size(); ++i)
    std::ranges::copy(data.inputs(cases[i]), inputs.row(static_cast<Eigen::Index>(i)).data());
  return inputs;
}

model::TargetTransform fit_transform(const field::FieldRows& data, std::span<const std::size_t> cases,
                                     model::TransformKind kind) {
  std::vector<float> values;
  if (kind != model::TransformKind::none) {
    for (const auto i : cases) {
      const auto own = data.values(i);
      values.insert(values.end(), own.begin(), own.end());
    }
  }
  return model::TargetTransform::fit(kind, values);
}

/// Fills the record table case by case.
class Filler {
 public:
  Filler(const field::FieldRows& data, RecordSet& set)
      : data_(data), set_(set), encoding_(set.planes.size()), scaled_(set.inputs.size()) {
    auto& records = set.records;
    records.n_planes = data.n_planes();
    const auto n_records = static_cast<Eigen::Index>(data.n_cases() * data.n_planes());
    const auto n_in = static_cast<Eigen::Index>(set.inputs.size() + set.planes.size());
    records.inputs.resize(n_records, n_in);
    records.targets.resize(n_records, static_cast<Eigen::Index>(data.n_columns()));
  }

  void add(std::size_t i_case) {
    set_.inputs.apply(data_.inputs(i_case), scaled_);
    for (std::size_t plane = 0; plane < set_.records.n_planes; ++plane)
      add_plane(plane, static_cast<std::int32_t>(i_case));
  }

 private:
  void add_plane(std::size_t plane, std::int32_t i_case) {
    auto& records = set_.records;
    set_.planes.encode(plane, encoding_);
    float* x = records.inputs.row(next_).data();
    std::ranges::copy(encoding_, std::ranges::copy(scaled_, x).out);
    const auto scale_row = set_.outputs.row(plane);
    const std::size_t n_columns = data_.n_columns();
    const auto values = data_.values(static_cast<std::size_t>(i_case)).subspan(plane * n_columns, n_columns);
    for (Eigen::Index c = 0; c < records.targets.cols(); ++c) {
      const float z = set_.transform.apply(values[static_cast<std::size_t>(c)]);
      const float deviation = set_.outputs.deviation(scale_row, c);
      records.targets(next_, c) = deviation > 0 ? (z - set_.outputs.mean(scale_row, c)) / deviation : 0.0F;
    }
    records.plane.push_back(static_cast<std::int32_t>(plane));
    records.case_of.push_back(i_case);
    ++next_;
  }

  const field::FieldRows& data_;
  RecordSet& set_;
  Eigen::Index next_ = 0;
  std::vector<float> encoding_, scaled_;
};

bool answers(const Band& band, std::size_t plane) {
  if (band.mask.empty()) return true;
  const auto first = band.mask.begin() + static_cast<std::ptrdiff_t>(plane * band.columns.size());
  return std::find(first, first + static_cast<std::ptrdiff_t>(band.columns.size()), 1) !=
         first + static_cast<std::ptrdiff_t>(band.columns.size());
}

std::vector<std::size_t> rows_of(const ScreeningData& records, const Band& band, std::span<const Part> part,
                                 Part wanted) {
  std::vector<bool> answered(records.n_planes);
  for (std::size_t plane = 0; plane < records.n_planes; ++plane) answered[plane] = answers(band, plane);
  std::vector<std::size_t> rows;
  for (std::size_t r = 0; r < part.size(); ++r)
    if (part[r] == wanted && answered[static_cast<std::size_t>(records.plane[r])]) rows.push_back(r);
  return rows;
}

void fill(const ScreeningData& records, const Band& band, std::span<const std::size_t> rows, MatrixF& inputs,
          MatrixF& targets, MatrixF& weights) {
  const auto n = static_cast<Eigen::Index>(rows.size()),
             n_out = static_cast<Eigen::Index>(band.columns.size());
  inputs.resize(n, records.inputs.cols());
  targets.resize(n, n_out);
  if (!band.mask.empty()) weights.resize(n, n_out);
  for (Eigen::Index r = 0; r < n; ++r) {
    const std::size_t row = rows[static_cast<std::size_t>(r)];
    const auto record = static_cast<Eigen::Index>(row);
    const auto plane = records.plane[row];
    inputs.row(r) = records.inputs.row(record);
    for (Eigen::Index c = 0; c < n_out; ++c) {
      targets(r, c) = records.targets(record, band.columns[static_cast<std::size_t>(c)]);
      if (!band.mask.empty()) weights(r, c) = band.mask[static_cast<std::size_t>(plane * n_out + c)];
    }
  }
}

/// The first few, with the square root of their energy as length, (n_cases, n_components).
Eigen::MatrixXd principal_components(const MatrixF& values) {
  const Eigen::MatrixXd centred = (values.rowwise() - values.colwise().mean()).cast<double>();
  const math::SymmetricEigen eigen = math::symmetric_eigen(centred * centred.transpose());
  const auto n = std::min(n_components, centred.rows());
  return eigen.vectors.rightCols(n) * eigen.values.tail(n).cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

/// 1 for the strongest input, at least `least_relevance`.
std::vector<double> relative_relevance(std::vector<double> relevance) {
  const double most = *std::ranges::max_element(relevance);
  for (auto& value : relevance) value = most > 0 ? std::max(value / most, least_relevance) : 1;
  return relevance;
}

std::vector<double> ridge_relevance(const MatrixD& inputs, const Eigen::MatrixXd& components) {
  const std::vector<double> penalties{0.1, 1, 10, 100, 1000};
  const auto ridge = math::fit_ridge(inputs, components, penalties);
  std::vector<double> relevance;
  for (Eigen::Index i = 0; i < ridge.weights.rows(); ++i)
    relevance.push_back(std::sqrt(ridge.weights.row(i).norm()));
  return relative_relevance(std::move(relevance));
}

/// What an input is divided by in the covariance of a process that all components share (ARD).
std::vector<double> gp_relevance(const MatrixD& inputs, const Eigen::MatrixXd& components) {
  const Eigen::VectorXd scale =
      (components.colwise().squaredNorm() / static_cast<double>(components.rows())).cwiseSqrt();
  const double rounding = 1e-6 * scale.maxCoeff();
  const auto inverse = scale.unaryExpr([&](double s) { return s > rounding ? 1 / s : 0; });
  // Of components that inputs explain without noise the last bits would decide, but for some noise.
  const auto gp = math::fit_gp(inputs, components * inverse.asDiagonal(),
                               {.start_lengths = {5.0}, .highest_signal = 100, .lowest_noise = 1e-6});
  std::vector<double> relevance;
  for (const double length : gp.length_scales) relevance.push_back(1 / length);
  return relative_relevance(std::move(relevance));
}

/// Known cases are dealt out as if the others were not there, then the others among themselves.
/// @param deal the parts of the records of cases with these loads
template <class Deal>
std::vector<Part> parts_of(const field::FieldRows& data, const RecordRecipe& recipe, const Deal& deal) {
  const auto n_planes = data.n_planes();
  std::vector<Part> parts(data.n_cases() * n_planes);
  for (const bool known : {true, false}) {
    std::vector<std::size_t> cases;
    std::vector<double> loads;
    for (std::size_t i = 0; i < data.n_cases(); ++i) {
      if ((recipe.known.empty() || std::ranges::binary_search(recipe.known, i)) != known) continue;
      cases.push_back(i);
      loads.push_back(data.load(i));
    }
    const std::vector<Part> dealt = deal(loads);
    for (std::size_t k = 0; k < cases.size(); ++k)
      std::copy_n(dealt.begin() + static_cast<std::ptrdiff_t>(k * n_planes), n_planes,
                  parts.begin() + static_cast<std::ptrdiff_t>(cases[k] * n_planes));
  }
  return parts;
}

}  // namespace

RecordSet make_records(const field::FieldRows& data, const std::vector<Part>& part,
                       const RecordOptions& options, std::span<const std::size_t> scaled_by) {
  const auto n_planes = data.n_planes();
  check(part.size() == data.n_cases() * n_planes, "records: a part for every record");
  const auto building = scaled_by.empty() ? math::all_rows(data.n_cases())
                                          : std::vector<std::size_t>(scaled_by.begin(), scaled_by.end());
  RecordSet set;
  set.transform = fit_transform(data, building, options.transform);
  {
    const auto values = transformed_rows(data, building, set.transform);
    const auto inputs = input_rows(data, building);
    set.inputs = model::InputScaler::fit(inputs, relevance_of(options.relevance, inputs, values));
    set.outputs = model::OutputScaler::fit(values, data.n_columns(), options.scale_cells);
  }
  set.planes = {.kind = options.encoding, .n_planes = n_planes};

  Filler filler(data, set);
  for (std::size_t i = 0; i < data.n_cases(); ++i) filler.add(i);
  set.records.part = part;
  return set;
}

RecordSource::RecordSource(const field::FieldData& data, std::span<const std::size_t> cases,
                           RecordRecipe recipe)
    : data_(data, cases), recipe_(std::move(recipe)), key_(base::digest_of_members(data_, recipe_)) {}

const RecordSet& RecordSource::get() const {
  std::call_once(once_, [&] {
    const auto parts = parts_of(data_, recipe_, [&](std::span<const double> loads) {
      return split_records(loads, data_.n_planes(), recipe_.parts, recipe_.seed);
    });
    set_ = make_records(data_, parts, recipe_.options, recipe_.known);
  });
  return set_;
}

std::vector<Part> RecordSource::parts_of_build(BuildNumber number) const {
  return parts_of(data_, recipe_, [&](std::span<const double> loads) {
    return build_parts(loads, data_.n_planes(), recipe_.parts, recipe_.seed, number);
  });
}

TrainingProblem make_problem(const ScreeningData& records, const Band& band, std::span<const Part> part) {
  TrainingProblem problem;
  fill(records, band, rows_of(records, band, part, Part::train), problem.train_inputs, problem.train_targets,
       problem.train_weights);
  fill(records, band, rows_of(records, band, part, Part::validation), problem.validation_inputs,
       problem.validation_targets, problem.validation_weights);
  return problem;
}

std::vector<double> relevance_of(Relevance kind, const MatrixD& inputs, const MatrixF& values) {
  if (kind == Relevance::none) return {};
  const MatrixD standardised = math::Standardiser(inputs).apply(inputs);
  const Eigen::MatrixXd components = principal_components(values);
  return kind == Relevance::linear ? ridge_relevance(standardised, components)
                                   : gp_relevance(standardised, components);
}

}  // namespace elrom::networks
