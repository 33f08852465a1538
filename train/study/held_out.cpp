#include "elrom/study/held_out.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"

namespace elrom::study {

namespace {

std::vector<std::string> names_of(const field::SnapshotStore& store) {
  std::vector<std::string> names;
  for (const auto& record : store.cases()) names.push_back(record.inputs.name);
  return names;
}

bool any_matches(const std::vector<std::string>& patterns, const std::string& name) {
  return std::ranges::any_of(patterns, [&](const auto& p) { return base::matches(name, p); });
}

}  // namespace

HeldOut hold_out(const std::vector<std::string>& names, const std::vector<std::string>& patterns,
                 const std::vector<std::string>& exclude) {
  HeldOut result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    auto& rows = any_matches(exclude, names[i])    ? result.excluded
                 : any_matches(patterns, names[i]) ? result.held_out
                                                   : result.building;
    rows.push_back(i);
  }
  if (result.building.size() < 2) {
    throw UsageError(
        {.what = "too few cases to build with",
         .where = "split.held_out, train.exclude",
         .found = std::to_string(result.building.size()) + " of " + std::to_string(names.size()) + " cases",
         .expected = "at least 2 that are neither held out nor excluded"});
  }
  return result;
}

HeldOut hold_out(const field::SnapshotStore& store, const std::vector<std::string>& patterns,
                 const std::vector<std::string>& exclude) {
  return hold_out(names_of(store), patterns, exclude);
}

void expect_matches(const field::SnapshotStore& store, const std::vector<std::string>& patterns,
                    const std::string& setting) {
  const auto names = names_of(store);
  for (const auto& pattern : patterns) {
    if (std::ranges::any_of(names, [&](const auto& name) { return base::matches(name, pattern); })) continue;
    throw UsageError({.what = "no case matches '" + pattern + "'",
                      .where = setting,
                      .advice = base::name_advice(pattern, names)});
  }
}

void write_split(const std::filesystem::path& path, const SplitNames& split) {
  auto json = io::json_head<nlohmann::ordered_json>(io::kinds::split);
  json.update({{"by", split.by},
               {"train", split.train},
               {"validation", split.validation},
               {"test", split.test},
               {"held_out", split.held_out},
               {"excluded", split.excluded}});
  base::write_text(path, json.dump(1) + "\n");
}

SplitNames read_split(const std::filesystem::path& path) {
  try {
    const auto json = nlohmann::json::parse(base::read_text(path));
    io::check_json_kind(json, io::kinds::split, path.string());
    return {json.at("by"),   json.at("train"),    json.at("validation"),
            json.at("test"), json.at("held_out"), json.value("excluded", std::vector<std::string>())};
  } catch (const nlohmann::json::exception& error) {
    throw InputError({.what = "no valid split file", .where = path.string(), .found = error.what()});
  }
}

}  // namespace elrom::study
