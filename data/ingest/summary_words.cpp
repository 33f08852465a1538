#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/ingest/store_summary.hpp"

namespace elrom::ingest {

namespace {

using Json = nlohmann::ordered_json;

std::string shown(const Json& value, int digits = 4) {
  return value.is_number() ? base::rounded(value.get<double>(), digits) : "-";
}

std::string percent(const Json& load) {
  return load.is_number() ? fmt::format("{:.1f} %", 100 * load.get<double>()) : "-";
}

std::string mesh_words(const Json& mesh) {
  const auto& box = mesh["centres_m"];
  const auto side = [&](const char* axis) {
    return shown(box[axis]["min"], 3) + " to " + shown(box[axis]["max"], 3);
  };
  return fmt::format(
      "{} planes x {} columns = {} cells, {} m3\n  cell centres: x {} m, y {} m, z {} m\n  digest {}\n",
      mesh["n_planes"].get<std::size_t>(), mesh["n_columns"].get<std::size_t>(),
      mesh["n_cells"].get<std::size_t>(), shown(mesh["volume_m3"], 6), side("x"), side("y"), side("z"),
      mesh["digest"].get<std::string>());
}

std::string range_table(const Json& entries, const char* heading) {
  std::string text =
      fmt::format("\n{:<30}{:<8}{:>12}{:>12}{:>12}\n", heading, "unit", "least", "mean", "most");
  for (const auto& entry : entries) {
    text += fmt::format("{:<30}{:<8}{:>12}{:>12}{:>12}\n", entry["name"].get<std::string>(),
                        entry["unit"].get<std::string>(), shown(entry["min"]), shown(entry["mean"]),
                        shown(entry["max"]));
  }
  return text;
}

std::string value_table(const Json& inputs) {
  std::string text;
  if (!inputs.empty()) text = fmt::format("\n{:<30}{:<8}{:>12}\n", "boundary condition", "unit", "value");
  for (const auto& input : inputs) {
    text += fmt::format("{:<30}{:<8}{:>12}\n", input["name"].get<std::string>(),
                        input["unit"].get<std::string>(), shown(input["value"], 6));
  }
  return text;
}

std::string furnace_words(const Json& furnace) {
  if (furnace.is_null()) return "furnace: not described (elrom-data import --furnace)\n";
  const auto list = [](const Json& items) {
    return items.empty() ? std::string("none") : base::join(items.get<std::vector<std::string>>(), ", ");
  };
  std::string text = fmt::format(
      "furnace: {}; solids of {} kg/m3, packing limit {}; outlet from {} m\n"
      "  mirrors {}; held out {}; repeated runs {}\n",
      furnace["name"].get<std::string>(), shown(furnace["solid_density_kg_per_m3"]),
      shown(furnace["packing_limit"]), shown(furnace["outlet_low_m"]), list(furnace["mirrors"]),
      list(furnace["held_out"]), list(furnace["repeats"]));
  for (const auto& opening : furnace["openings"])
    text +=
        fmt::format("  {:<28}{:<16}{} to {} m\n", opening["inputs"].get<std::string>(),
                    opening["kind"].get<std::string>(), shown(opening["low_m"]), shown(opening["high_m"]));
  return text;
}

// Nothing for cases that state no load.
std::string loads_of(const Json& load) {
  if (!load["min"].is_number()) return "";
  return fmt::format(", loads {} to {}", percent(load["min"]), percent(load["max"]));
}

std::string load_of(const Json& one) {
  return one["load"].is_number() ? ": load " + percent(one["load"]) + "," : ":";
}

std::string store_words(const Json& store) {
  const auto n = store["n_cases"].get<std::size_t>();
  std::string text = fmt::format("snapshot store {}: {} {}{}\nmesh: ", store["path"].get<std::string>(), n,
                                 n == 1 ? "case" : "cases", loads_of(store["load"]));
  text += mesh_words(store["mesh"]) + furnace_words(store["furnace"]);
  text += range_table(store["inputs"], "boundary condition") + range_table(store["fields"], "field");
  text += fmt::format("\n{:<30}{:>8}{:>12}  {}\n", "case", "load", "averaged", "from");
  for (const auto& one : store["cases"]) {
    text += fmt::format("{:<30}{:>8}{:>10} s  {}\n", one["name"].get<std::string>(), percent(one["load"]),
                        shown(one["averaging_window_s"]), one["source"].get<std::string>());
  }
  return text + "digest " + store["digest"].get<std::string>() + "\n";
}

std::string case_words(const Json& one) {
  const auto& box = one["centres_m"];
  const auto side = [&](const char* axis) {
    return shown(box[axis]["min"], 3) + " to " + shown(box[axis]["max"], 3);
  };
  std::string text =
      fmt::format("case {}{} averaged over {} s, {} cells\n  cell centres: x {} m, y {} m, z {} m\n",
                  one["name"].get<std::string>(), load_of(one), shown(one["averaging_window_s"]),
                  one["n_cells"].get<std::size_t>(), side("x"), side("y"), side("z"));
  text += value_table(one["inputs"]);
  return text + range_table(one["fields"], "field") + "digest " + one["digest"].get<std::string>() + "\n";
}

/// Training cases with the beginnings of their digests, four a line.
std::string case_words_of(const Json& bundle) {
  if (!bundle.contains("case_digests")) return {};
  std::string text = "training cases, and the beginning of each one's digest";
  for (std::size_t i = 0; i < bundle["cases"].size(); ++i) {
    const auto digest = bundle["case_digests"][i].get<std::string>().substr(0, 8);
    text += fmt::format("{}{:<18}{:<10}", i % 4 == 0 ? "\n  " : "", bundle["cases"][i].get<std::string>(),
                        digest);
  }
  return text + "\n";
}

std::string bundle_words(const Json& bundle) {
  std::string text =
      fmt::format("model of method '{}', trained on {} cases\nmesh: ", bundle["method"].get<std::string>(),
                  bundle["cases"].size());
  text += mesh_words(bundle["mesh"]) + furnace_words(bundle["furnace"]);
  text += fmt::format("\n{:<30}{:<8}{}\n", "field", "unit", "predicted by");
  for (const auto& field : bundle["fields"]) {
    text += fmt::format("{:<30}{:<8}{}\n", field["name"].get<std::string>(), field["unit"].get<std::string>(),
                        field["model"].get<std::string>());
  }
  text += fmt::format("\n{:<30}{}\n", "boundary condition", "unit");
  for (const auto& input : bundle["inputs"]) {
    text += fmt::format("{:<30}{}\n", input["name"].get<std::string>(), input["unit"].get<std::string>());
  }
  text += "\nmade from\n";
  for (const auto& [key, value] : bundle["provenance"].items()) {
    text += fmt::format("  {:<28}{}\n", key, value.get<std::string>());
  }
  return text + case_words_of(bundle) + "digest " + bundle["digest"].get<std::string>() + "\n";
}

std::string prediction_words(const Json& one) {
  std::string text = fmt::format("prediction of case {}{} {} planes{}\n", one["case"].get<std::string>(),
                                 load_of(one), one["n_planes"].get<std::size_t>(),
                                 one["profiles"].get<bool>() ? ", averages of each" : "");
  text += fmt::format("validity: {} ({})\n", one["validity"].get<std::string>(),
                      one["validity_reason"].get<std::string>());
  text += fmt::format("model of method '{}', {} of the builds, by {}\n", one["method"].get<std::string>(),
                      one["builds"].get<std::string>(), one["bundle_program"].get<std::string>());
  if (one["interval_level"].is_number())
    text += "with intervals of level " + shown(one["interval_level"]) + "\n";
  text += value_table(one["inputs"]) + range_table(one["fields"], "field");
  return text + "bundle digest " + one["bundle_digest"].get<std::string>() + "\n";
}

}  // namespace

std::string in_words(const Json& description) {
  const auto kind = description["kind"].get<std::string>();
  if (kind == "store") return store_words(description);
  if (kind == "mesh") return "reduced mesh: " + mesh_words(description);
  if (kind == "bundle") return bundle_words(description);
  if (kind == "prediction") return prediction_words(description);
  return case_words(description);
}

}  // namespace elrom::ingest
