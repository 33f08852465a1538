// Files of fields that come through a repository, as cases: to be judged by themselves and, when a simulation
// made them, to be learned from. A simulation's file names no bundle.
#include "elrom/ingest/judge_fields.hpp"

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/ingest/check.hpp"
#include "elrom/model/prediction_file.hpp"

namespace elrom::ingest {
namespace {

bool is_whole(const model::StoredPrediction& stored) {
  return !stored.profiles && stored.cells.empty() && !stored.fields.empty();
}

void expect_simulation(const model::StoredPrediction& stored, const std::string& where) {
  if (!stored.bundle_digest.empty())
    throw InputError({.what = "a model's prediction is no case to learn from",
                      .where = where,
                      .found = "bundle " + stored.bundle_digest.substr(0, 12)});
  if (!is_whole(stored))
    throw InputError(
        {.what = "fields of a part of the furnace", .where = where, .expected = "all of its cells"});
}

void take_inputs(CfdCase& one, const model::StoredPrediction& stored) {
  std::vector<field::InputInfo> inputs;
  for (std::size_t i = 0; i < stored.inputs.size(); ++i)
    inputs.push_back({stored.input_names[i], stored.input_units[i], stored.input_units[i]});
  one.schema = field::InputSchema(std::move(inputs));
  one.record.inputs = {stored.case_name, stored.load.value_or(std::nan("")), stored.inputs};
}

void take_cells(CfdCase& one, const model::StoredPrediction& stored) {
  const auto n_cells = static_cast<Eigen::Index>(stored.centre.size() / 3);
  one.centre = Eigen::Map<const MatrixF>(stored.centre.data(), n_cells, 3).cast<double>();
  one.values.resize(static_cast<Eigen::Index>(stored.fields.size()), n_cells);
  for (Eigen::Index f = 0; f < one.values.rows(); ++f) {
    const auto& field = stored.fields[static_cast<std::size_t>(f)];
    one.fields.push_back(field::field_info(field.name, field.unit));
    one.values.row(f) = Eigen::Map<const Eigen::RowVectorXf>(field.values.data(), n_cells);
  }
}

/// The digest of a mesh is a word; where the cells lie says whether it is true.
void expect_on(const field::Mesh& mesh, const CfdCase& one, const std::string& where) {
  constexpr double room = 1e-5;  // of the furnace's size: centres are kept as float32
  const double size = mesh.centre.cwiseAbs().maxCoeff();
  if ((one.centre - mesh.centre).cwiseAbs().maxCoeff() <= room * size) return;
  throw InputError({.what = "cells lie elsewhere than their mesh says", .where = where});
}

CfdCase case_of(const model::StoredPrediction& stored) {
  CfdCase one;
  take_inputs(one, stored);
  take_cells(one, stored);
  return one;
}

}  // namespace

CfdCase read_simulation(const std::filesystem::path& path) {
  const auto stored = model::read_prediction(path);
  expect_simulation(stored, path.string());
  return case_of(stored);
}

void judge_physics_of(const std::filesystem::path& file, const field::Mesh& mesh,
                      const std::optional<field::Furnace>& furnace) {
  const auto stored = model::read_prediction(file);
  if (!is_whole(stored) || stored.centre.size() != 3 * mesh.n_cells()) return;
  auto one = case_of(stored);
  expect_on(mesh, one, file.filename().string());
  one.volume = mesh.volume;
  Checker checker;
  checker.add(view_of(one, &mesh, furnace ? &*furnace : nullptr));
  for (const auto& finding : checker.findings())
    if (finding.severity != Severity::note)
      throw InputError({.what = line_of(finding), .where = file.filename().string()});
}

}  // namespace elrom::ingest
