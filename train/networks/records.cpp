#include "elrom/networks/records.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/math/gaussian_process.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/ridge.hpp"
#include "elrom/math/standardiser.hpp"

namespace elrom::networks {
namespace {

constexpr double least_relevance = 0.1;
constexpr Eigen::Index n_components = 10;

// Numbers of the cases that have a training record.
std::vector<std::size_t> training_cases(const field::FieldRows& data, const std::vector<Part>& part,
                                        std::span<const std::size_t> among) {
  const std::size_t n_planes = data.n_planes();
  std::vector<std::size_t> cases;
  for (std::size_t i = 0; i < data.n_cases(); ++i) {
    if (!among.empty() && !std::ranges::binary_search(among, i)) continue;
    const auto first = part.begin() + static_cast<std::ptrdiff_t>(i * n_planes);
    if (std::count(first, first + static_cast<std::ptrdiff_t>(n_planes), Part::train) > 0) cases.push_back(i);
  }
  check(!cases.empty(), "records: no training record");
  return cases;
}

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

// Fills the record table case by case, image by image.
class Filler {
 public:
  Filler(const field::FieldRows& data, RecordSet& set, std::size_t n_records)
      : data_(data),
        set_(set),
        n_columns_(static_cast<Eigen::Index>(data.n_columns())),
        encoding_(set.planes.size()),
        scaled_(set.inputs.size()),
        image_(data.n_planes() * data.n_columns()) {
    auto& records = set.records;
    records.n_planes = data.n_planes();
    const auto n_in = static_cast<Eigen::Index>(set.inputs.size() + set.planes.size());
    records.inputs.resize(static_cast<Eigen::Index>(n_records), n_in);
    records.targets.resize(static_cast<Eigen::Index>(n_records), n_columns_);
  }

  /// @param mirror nullptr: the case itself @param parts of its planes @param only_training leaves other
  /// records out
  void add(std::size_t i_case, const field::Mirror* mirror, const Part* parts, bool only_training) {
    load_image(i_case, mirror);
    for (std::size_t plane = 0; plane < set_.records.n_planes; ++plane) {
      if (!only_training || parts[plane] == Part::train)
        add_plane(plane, static_cast<std::int32_t>(i_case), parts[plane]);
    }
  }
  void end() {
    auto& records = set_.records;
    records.inputs.conservativeResize(next_, Eigen::NoChange);
    records.targets.conservativeResize(next_, Eigen::NoChange);
  }

 private:
  void load_image(std::size_t i_case, const field::Mirror* mirror) {
    const auto inputs = data_.inputs(i_case);
    std::vector<double> values(inputs.begin(), inputs.end());
    const auto from = data_.values(i_case);
    if (mirror == nullptr) {
      std::ranges::copy(from, image_.begin());
    } else {
      values = mirror->apply_to_inputs(values);
      const auto sign = static_cast<float>(mirror->field_sign(data_.info().parity));
      for (std::size_t c = 0; c < image_.size(); ++c)
        image_[c] = sign * from[static_cast<std::size_t>(mirror->cell_from[c])];
    }
    set_.inputs.apply(values, scaled_);
  }

  void add_plane(std::size_t plane, std::int32_t i_case, Part part) {
    auto& records = set_.records;
    set_.planes.encode(plane, encoding_);
    float* x = records.inputs.row(next_).data();
    std::ranges::copy(encoding_, std::ranges::copy(scaled_, x).out);
    const auto scale_row = set_.outputs.row(plane);
    for (Eigen::Index c = 0; c < n_columns_; ++c) {
      const float z = set_.transform.apply(
          image_[plane * static_cast<std::size_t>(n_columns_) + static_cast<std::size_t>(c)]);
      const float deviation = set_.outputs.deviation(scale_row, c);
      records.targets(next_, c) = deviation > 0 ? (z - set_.outputs.mean(scale_row, c)) / deviation : 0.0F;
    }
    records.plane.push_back(static_cast<std::int32_t>(plane));
    records.case_of.push_back(i_case);
    records.part.push_back(part);
    ++next_;
  }

  const field::FieldRows& data_;
  RecordSet& set_;
  Eigen::Index n_columns_, next_ = 0;
  std::vector<float> encoding_, scaled_, image_;
};

struct Rows {
  std::vector<std::uint32_t> train, validation;
};

bool answers(const Band& band, std::size_t plane) {
  if (band.mask.empty()) return true;
  const auto first = band.mask.begin() + static_cast<std::ptrdiff_t>(plane * band.columns.size());
  return std::find(first, first + static_cast<std::ptrdiff_t>(band.columns.size()), 1) !=
         first + static_cast<std::ptrdiff_t>(band.columns.size());
}

std::vector<std::uint32_t> rows_of(const ScreeningData& records, const Band& band, Part part) {
  auto rows = records.rows(part);
  std::vector<bool> wanted(records.n_planes);
  for (std::size_t plane = 0; plane < records.n_planes; ++plane) wanted[plane] = answers(band, plane);
  std::erase_if(rows, [&](std::uint32_t r) { return !wanted[static_cast<std::size_t>(records.plane[r])]; });
  return rows;
}

void fill(const ScreeningData& records, const Band& band, Part part, MatrixF& inputs, MatrixF& targets,
          MatrixF& weights) {
  const auto rows = rows_of(records, band, part);
  const auto n = static_cast<Eigen::Index>(rows.size()),
             n_out = static_cast<Eigen::Index>(band.columns.size());
  inputs.resize(n, records.inputs.cols());
  targets.resize(n, n_out);
  if (!band.mask.empty()) weights.resize(n, n_out);
  for (Eigen::Index r = 0; r < n; ++r) {
    const auto row = rows[static_cast<std::size_t>(r)];
    inputs.row(r) = records.inputs.row(row);
    for (Eigen::Index c = 0; c < n_out; ++c) {
      targets(r, c) = records.targets(row, band.columns[static_cast<std::size_t>(c)]);
      if (!band.mask.empty()) {
        weights(r, c) = band.mask[static_cast<std::size_t>(records.plane[row] * n_out + c)];
      }
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
std::vector<Part> parts_of(const field::FieldRows& data, const RecordRecipe& recipe) {
  const auto n_planes = data.n_planes();
  std::vector<Part> parts(data.n_cases() * n_planes);
  const auto deal = [&](bool known) {
    std::vector<std::size_t> cases;
    std::vector<double> loads;
    for (std::size_t i = 0; i < data.n_cases(); ++i) {
      if ((recipe.known.empty() || std::ranges::binary_search(recipe.known, i)) != known) continue;
      cases.push_back(i);
      loads.push_back(data.load(i));
    }
    const auto dealt = split_records(loads, n_planes, recipe.parts, recipe.seed);
    for (std::size_t k = 0; k < cases.size(); ++k)
      std::copy_n(dealt.begin() + static_cast<std::ptrdiff_t>(k * n_planes), n_planes,
                  parts.begin() + static_cast<std::ptrdiff_t>(cases[k] * n_planes));
  };
  deal(true);
  deal(false);
  return parts;
}

}  // namespace

RecordSet make_records(const field::FieldRows& data, const std::vector<Part>& part,
                       const RecordOptions& options, std::span<const std::size_t> scaled_by) {
  const auto n_planes = data.n_planes();
  check(part.size() == data.n_cases() * n_planes, "records: a part for every record");
  const auto building = training_cases(data, part, scaled_by);
  RecordSet set;
  set.transform = fit_transform(data, building, options.transform);
  {
    const auto values = transformed_rows(data, building, set.transform);
    const auto inputs = input_rows(data, building);
    set.inputs = model::InputScaler::fit(inputs, relevance_of(options.relevance, inputs, values));
    set.outputs = model::OutputScaler::fit(values, data.n_columns(), options.scale_cells);
  }
  set.planes = {.kind = options.encoding, .n_planes = n_planes};

  const auto group = options.mirrors
                         ? field::symmetry_group(data.mirrors(), data.n_inputs(), n_planes * data.n_columns())
                         : std::vector<field::Mirror>{};
  Filler filler(data, set, part.size() * std::max<std::size_t>(group.size(), 1));
  for (std::size_t i = 0; i < data.n_cases(); ++i) filler.add(i, nullptr, &part[i * n_planes], false);
  for (std::size_t g = 1; g < group.size(); ++g)
    for (std::size_t i = 0; i < data.n_cases(); ++i) filler.add(i, &group[g], &part[i * n_planes], true);
  filler.end();
  return set;
}

RecordSource::RecordSource(const field::FieldData& data, std::span<const std::size_t> cases,
                           RecordRecipe recipe)
    : data_(data, cases, recipe.options.mirrors),
      recipe_(std::move(recipe)),
      key_(base::digest_of_members(data_, recipe_)) {}

const RecordSet& RecordSource::get() const {
  std::call_once(
      once_, [&] { set_ = make_records(data_, parts_of(data_, recipe_), recipe_.options, recipe_.known); });
  return set_;
}

TrainingProblem make_problem(const ScreeningData& records, const Band& band) {
  TrainingProblem problem;
  fill(records, band, Part::train, problem.train_inputs, problem.train_targets, problem.train_weights);
  fill(records, band, Part::validation, problem.validation_inputs, problem.validation_targets,
       problem.validation_weights);
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
