#include "elrom/study/held_out.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"

namespace elrom::study {

HeldOut hold_out(const std::vector<std::string>& names, const std::vector<std::string>& patterns) {
  HeldOut result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool out = std::ranges::any_of(patterns, [&](const auto& p) { return base::matches(names[i], p); });
    (out ? result.held_out : result.building).push_back(i);
  }
  if (result.building.size() < 2) {
    throw UsageError(
        {.what = "too few cases to build with",
         .where = "split.held_out",
         .found = std::to_string(result.building.size()) + " of " + std::to_string(names.size()) + " cases",
         .expected = "at least 2 that are not held out"});
  }
  return result;
}

HeldOut hold_out(const field::SnapshotStore& store, const std::vector<std::string>& patterns) {
  std::vector<std::string> names;
  for (const auto& record : store.cases()) names.push_back(record.inputs.name);
  return hold_out(names, patterns);
}

void write_split(const std::filesystem::path& path, const SplitNames& split) {
  auto json = io::json_head<nlohmann::ordered_json>(io::kinds::split);
  json.update({{"by", split.by},
               {"train", split.train},
               {"validation", split.validation},
               {"test", split.test},
               {"held_out", split.held_out}});
  base::write_text(path, json.dump(1) + "\n");
}

SplitNames read_split(const std::filesystem::path& path) {
  try {
    const auto json = nlohmann::json::parse(base::read_text(path));
    io::check_json_kind(json, io::kinds::split, path.string());
    return {json.at("by"), json.at("train"), json.at("validation"), json.at("test"), json.at("held_out")};
  } catch (const nlohmann::json::exception& error) {
    throw InputError({.what = "no valid split file", .where = path.string(), .found = error.what()});
  }
}

}  // namespace elrom::study
