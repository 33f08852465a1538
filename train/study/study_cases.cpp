#include "elrom/base/error.hpp"
#include "elrom/study/study.hpp"

namespace elrom::study {
namespace {

std::vector<field::Mirror> resolved_mirrors(const field::SnapshotStore& store, const Settings& settings,
                                            Log& log) {
  std::vector<field::Mirror> mirrors;
  if (!settings.symmetry.enabled) return mirrors;
  const bool declared = !settings.symmetry.mirrors.empty();
  for (const auto& mirror : declared ? settings.symmetry.mirrors : furnace_mirrors()) {
    try {
      mirrors.push_back(field::resolve(mirror, store.schema(), store.mesh()));
    } catch (const InputError& error) {
      if (declared) throw;
      log.detail("no mirror '" + mirror.name + "' on these cases: " + error.what());
    }
  }
  return mirrors;
}

}  // namespace

field::CaseSet study_cases(const field::SnapshotStore& store, const Settings& settings,
                           const std::vector<std::size_t>& rows, Log& log) {
  field::CaseSet cases;
  cases.mesh = store.mesh();
  cases.schema = store.schema();
  cases.inputs = store.inputs(rows);
  for (const auto row : rows) {
    cases.names.push_back(store.cases()[row].inputs.name);
    cases.loads.push_back(store.cases()[row].inputs.load);
  }
  cases.mirrors = resolved_mirrors(store, settings, log);
  return cases;
}

}  // namespace elrom::study
