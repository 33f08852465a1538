#include "elrom/ingest/store_summary.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "elrom/base/units.hpp"
#include "value_range.hpp"

namespace elrom::ingest {

namespace {

using Json = nlohmann::ordered_json;

Json extents(const MatrixD& centre) {
  Json box;
  for (const auto& [name, column] : {std::pair("x", 0), std::pair("y", 1), std::pair("z", 2)}) {
    box[name] = {{"min", centre.col(column).minCoeff()}, {"max", centre.col(column).maxCoeff()}};
  }
  return box;
}

Json input_range(const field::InputInfo& input, const std::vector<double>& si) {
  const auto& unit = base::unit(input.display_unit);
  ValueRange range;
  for (const double value : si) range.add(unit.from_si(value));
  Json entry{{"name", input.name}, {"unit", input.display_unit}};
  entry.update(range.json());
  return entry;
}

Json field_range(const field::FieldInfo& field, const ValueRange& range) {
  Json entry{{"name", field.name}, {"unit", field.unit}, {"meaning", field.meaning}};
  entry.update(range.json());
  return entry;
}

ValueRange load_range(const field::SnapshotStore& store) {
  ValueRange range;
  for (const auto& one : store.cases()) range.add(one.inputs.load);
  return range;
}

std::vector<std::size_t> all_cases(const field::SnapshotStore& store) {
  std::vector<std::size_t> cases(store.n_cases());
  std::iota(cases.begin(), cases.end(), std::size_t{0});
  return cases;
}

Json case_entry(const field::SnapshotStore& store, std::size_t i) {
  const auto& one = store.cases()[i];
  Json entry{{"name", one.inputs.name},
             {"load", number_or_null(one.inputs.load)},
             {"averaging_window_s", one.averaging_window_s},
             {"source", one.source},
             {"source_digest", one.source_digest}};
  for (std::size_t f = 0; f < one.resampling_error.size(); ++f)
    entry["resampling_error"][store.fields()[f].name] = number_or_null(one.resampling_error[f]);
  return entry;
}

/// Null: nobody described it.
Json describe_furnace(const std::optional<field::Furnace>& furnace) {
  if (!furnace) return nullptr;
  Json entry{{"name", furnace->name},
             {"solid_density_kg_per_m3", furnace->solid_density},
             {"packing_limit", furnace->packing_limit},
             {"outlet_low_m", number_or_null(furnace->outlet_low_m)},
             {"held_out", furnace->held_out},
             {"repeats", furnace->repeats}};
  entry["openings"] = Json::array();
  for (const auto& opening : furnace->openings)
    entry["openings"].push_back({{"inputs", opening.inputs},
                                 {"kind", opening.kind},
                                 {"low_m", opening.low_m},
                                 {"high_m", opening.high_m}});
  entry["mirrors"] = Json::array();
  for (const auto& mirror : furnace->mirrors) entry["mirrors"].push_back(mirror.name);
  return entry;
}

}  // namespace

Json describe_mesh(const field::Mesh& mesh) {
  return {{"kind", "mesh"},
          {"n_planes", mesh.n_planes},
          {"n_columns", mesh.n_columns},
          {"n_cells", mesh.n_cells()},
          {"volume_m3", std::accumulate(mesh.volume.begin(), mesh.volume.end(), 0.0)},
          {"centres_m", extents(mesh.centre)},
          {"digest", mesh.digest()}};
}

Json describe_store(const field::SnapshotStore& store) {
  const auto cases = all_cases(store);
  Json result{{"kind", "store"},
              {"path", store.path().string()},
              {"n_cases", store.n_cases()},
              {"load", load_range(store).json()}};
  result["mesh"] = describe_mesh(store.mesh());
  result["furnace"] = describe_furnace(store.furnace());
  result["inputs"] = Json::array();
  const auto inputs = store.inputs(cases);
  for (std::size_t i = 0; i < store.schema().size(); ++i) {
    const auto column = inputs.col(static_cast<Eigen::Index>(i));
    result["inputs"].push_back(
        input_range(store.schema()[i], std::vector<double>(column.begin(), column.end())));
  }
  result["fields"] = Json::array();
  for (const auto& field : store.fields()) {
    ValueRange range;
    for (const auto i : cases) {  // one case at a time: stores are larger than memory
      const auto values = store.read(field.name, {&i, 1});
      for (const float value : values.reshaped()) range.add(static_cast<double>(value));
    }
    result["fields"].push_back(field_range(field, range));
  }
  result["cases"] = Json::array();
  for (const auto i : cases) result["cases"].push_back(case_entry(store, i));
  result["digest"] = store.digest(cases);
  return result;
}

Json describe_case(const CfdCase& one) {
  Json result{{"kind", "case"},
              {"name", one.record.inputs.name},
              {"load", number_or_null(one.record.inputs.load)},
              {"averaging_window_s", one.record.averaging_window_s},
              {"n_cells", one.centre.rows()}};
  if (!one.volume.empty()) result["volume_m3"] = std::accumulate(one.volume.begin(), one.volume.end(), 0.0);
  result["centres_m"] = extents(one.centre);
  result["inputs"] = Json::array();
  for (std::size_t i = 0; i < one.schema.size(); ++i) {
    result["inputs"].push_back(
        {{"name", one.schema[i].name},
         {"unit", one.schema[i].display_unit},
         {"value", base::unit(one.schema[i].display_unit).from_si(one.record.inputs.values[i])}});
  }
  result["fields"] = Json::array();
  for (std::size_t f = 0; f < one.fields.size(); ++f) {
    ValueRange range;
    for (const float value : one.values.row(static_cast<Eigen::Index>(f)))
      range.add(static_cast<double>(value));
    result["fields"].push_back(field_range(one.fields[f], range));
  }
  result["digest"] = one.record.source_digest;
  return result;
}

Json describe_bundle(const model::BundleReader& bundle) {
  const auto& info = bundle.info();
  Json result{{"kind", "bundle"}, {"method", info.method}, {"mesh", describe_mesh(bundle.mesh())}};
  result["furnace"] = describe_furnace(bundle.furnace());
  result["inputs"] = Json::array();
  for (const auto& input : info.schema.inputs()) {
    result["inputs"].push_back({{"name", input.name}, {"unit", input.display_unit}});
  }
  result["fields"] = Json::array();
  for (const auto& field : info.fields) {
    result["fields"].push_back(
        {{"name", field.name}, {"unit", field.unit}, {"model", bundle.model(field.name)->kind()}});
  }
  result["cases"] = info.cases;
  if (!info.case_digests.empty()) result["case_digests"] = info.case_digests;
  result["provenance"] = info.provenance;
  if (!info.settings.empty()) result["settings"] = info.settings;
  result["accuracy"] = Json::parse(info.accuracy_json, nullptr, false);
  if (result["accuracy"].is_discarded()) result["accuracy"] = nullptr;
  result["digest"] = bundle.digest();
  return result;
}

}  // namespace elrom::ingest
