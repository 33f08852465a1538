#include "elrom/base/error.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/study.hpp"

namespace elrom::study {
namespace {

std::vector<field::Mirror> resolved_mirrors(const field::SnapshotStore& store, const Settings& settings,
                                            Log& log) {
  std::vector<field::Mirror> mirrors;
  if (!settings.symmetry.enabled) return mirrors;
  const bool declared = !settings.symmetry.mirrors.empty();
  if (!declared && !store.furnace())
    log.info("no mirror images: the store has no furnace description, and study.toml declares none");
  const auto of_furnace =
      store.furnace() ? store.furnace()->mirrors : std::vector<field::MirrorDeclaration>();
  for (const auto& mirror : declared ? settings.symmetry.mirrors : of_furnace) {
    try {
      mirrors.push_back(field::resolve(mirror, store.schema(), store.mesh()));
    } catch (const InputError& error) {
      if (declared) throw;
      log.info("mirror '" + mirror.name + "' of the furnace not used: " + error.what());
    }
  }
  return mirrors;
}

}  // namespace

std::vector<std::string> held_out_patterns(const field::SnapshotStore& store, const Settings& settings,
                                           Log& log) {
  if (settings.split.held_out) {
    expect_matches(store, *settings.split.held_out, "split.held_out");
    return *settings.split.held_out;
  }
  if (!store.furnace()) {
    log.warning("no case is held out: the store has no furnace description, and study.toml names none");
    return {};
  }
  for (const auto& pattern : store.furnace()->held_out) {
    if (store.find(pattern).empty())
      log.warning("no case matches '" + pattern + "', held out by the store's furnace description");
  }
  return store.furnace()->held_out;
}

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
