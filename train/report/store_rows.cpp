#include "store_rows.hpp"

#include <algorithm>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::report {

std::vector<std::string> named_cases(const field::SnapshotStore& store,
                                     const std::vector<std::string>& patterns) {
  std::vector<std::string> names, known;
  for (const auto& one : store.cases()) known.push_back(one.inputs.name);
  for (const auto& pattern : patterns) {
    const auto found = store.find(pattern);
    if (found.empty())
      throw UsageError({.what = "the store holds no case '" + pattern + "'",
                        .where = store.path().string(),
                        .advice = base::name_advice(pattern, known)});
    for (const auto row : found)
      if (std::ranges::find(names, known[row]) == names.end()) names.push_back(known[row]);
  }
  return names;
}

std::vector<std::size_t> judging_rows(const field::SnapshotStore& store,
                                      const std::vector<std::string>& names) {
  std::vector<std::size_t> rows;
  for (const auto& name : names) {
    const auto found = store.find(name);
    if (found.size() != 1)
      throw InputError({.what = "case '" + name + "', which the study held out, is missing",
                        .where = store.path().string(),
                        .advice = "judge on others by --cases, or name a store that holds it by --store"});
    rows.push_back(found.front());
  }
  return rows;
}

std::vector<std::size_t> learnt_rows(const field::SnapshotStore& store, const std::vector<std::string>& names,
                                     Log& log) {
  std::vector<std::size_t> rows;
  std::vector<std::string> missing;
  for (const auto& name : names) {
    const auto found = store.find(name);
    found.size() == 1 ? rows.push_back(found.front()) : missing.push_back(name);
  }
  if (rows.empty())
    throw InputError({.what = "the store holds no case that the study was trained on",
                      .where = store.path().string(),
                      .advice = "name the store it was trained on by --store"});
  if (!missing.empty())
    log.warning("not in the store any more: " + base::join(missing, ", ") +
                "; what the training cases tell is told by the other " + std::to_string(rows.size()));
  return rows;
}

}  // namespace elrom::report
