#include "held_out_cases.hpp"

#include "elrom/base/error.hpp"
#include "elrom/study/scores.hpp"
#include "store_rows.hpp"

namespace elrom::report {
namespace {

// The study's held-out cases, and repeated runs that came into the store since it was trained.
std::vector<std::size_t> judged_rows(const field::SnapshotStore& store, const StudyFiles& study) {
  auto rows = judging_rows(store, study.held_out);
  for (std::size_t row = 0; row < store.n_cases() && store.furnace(); ++row) {
    const auto& name = store.cases()[row].inputs.name;
    if (store.furnace()->is_repeat(name) && std::ranges::find(study.building, name) == study.building.end() &&
        std::ranges::find(rows, row) == rows.end())
      rows.push_back(row);
  }
  return rows;
}

}  // namespace

HeldOutCases hold_out_cases(const field::SnapshotStore& store, const StudyFiles& study, Log& log) {
  const auto judged = study::judged_cases(store, judged_rows(store, study));
  HeldOutCases cases{.building = {}, .scored = judged.scored, .repeats = judged.repeats, .inputs = {}};
  if (cases.scored.empty())
    throw UsageError({.what = "no held-out case to score",
                      .where = study.directory.string(),
                      .advice = "name some in study.toml: [split] held_out = [\"load_*\"]"});
  cases.building = learnt_rows(store, study.building, log);
  cases.inputs = store.inputs(cases.scored);
  return cases;
}

AveragedTruth averaged_truth(const field::SnapshotStore& store, const std::string& field,
                             const HeldOutCases& cases) {
  AveragedTruth truth;
  for (std::size_t i = 0; i < cases.scored.size(); ++i) {
    const MatrixF runs = store.read(field, cases.runs_of(i));
    const auto n = static_cast<double>(runs.rows());
    truth.values.conservativeResize(static_cast<Eigen::Index>(i) + 1, runs.cols());
    truth.values.row(static_cast<Eigen::Index>(i)) = (runs.cast<double>().colwise().mean()).cast<float>();
    truth.noise.push_back(study::noise_energy(runs) / n);
  }
  return truth;
}

}  // namespace elrom::report
