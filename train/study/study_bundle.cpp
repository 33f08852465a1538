#include "study_bundle.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/version.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::study {
std::string content_of(const StudyBundle& bundle, const FieldStages& stages) {
  std::map<std::string, std::string> keys;
  for (const auto& [field, stage] : stages) keys[field] = stage.file.text("stage_digest");
  return base::digest_of_members(bundle, keys, std::string_view(program_version()));
}

bool holds_content(const std::filesystem::path& path, const std::string& content) {
  if (!std::filesystem::exists(path)) return false;
  try {
    const model::BundleReader reader(path);
    const auto found = reader.info().provenance.find("content");
    if (found == reader.info().provenance.end() || found->second != content) return false;
    reader.file().verify_all();
    return true;
  } catch (const Error&) {
    return false;  // another kind, another version or damaged: it is written again
  }
}

std::vector<model::UsualFigure> usual_audit_of(const field::SnapshotStore& store,
                                               std::span<const std::size_t> rows) {
  if (!store.furnace() || store.mesh().volume.empty()) return {};
  const auto settings = model::audit_settings(store.furnace());
  std::vector<field::FieldInfo> fields;
  for (const auto& info : store.fields())
    if (std::ranges::find(model::audited_fields, info.name) != model::audited_fields.end())
      fields.push_back(info);
  std::vector<model::Audit> audits;
  for (const auto row : rows) {
    std::vector<float> values;
    for (const auto& info : fields) {
      const auto cells = store.read(info.name, {&row, 1});
      values.insert(values.end(), cells.data(), cells.data() + cells.size());
    }
    audits.push_back(model::audit({.mesh = store.mesh(),
                                   .schema = store.schema(),
                                   .inputs = store.cases()[row].inputs.values,
                                   .fields = fields,
                                   .values = values},
                                  settings));
  }
  return model::usual_figures(audits);
}

void write_study_bundle(const std::filesystem::path& path, const StudyBundle& study, const Lineage& lineage,
                        const FieldStages& stages) {
  const auto content = content_of(study, stages);
  if (holds_content(path, content)) return;
  model::Bundle bundle;
  bundle.info.method = study.method;
  bundle.info.fields = study.fields;
  bundle.info.schema = study.cases.schema;
  bundle.info.cases = study.cases.names;
  bundle.info.case_digests = lineage.case_digests;
  bundle.info.settings = lineage.settings;
  bundle.info.usual_audit = lineage.usual_audit;
  bundle.info.provenance = {{"program", program_version()},
                            {"store", study.store_digest},
                            {"settings", study.settings_digest},
                            {"content", content}};
  if (!lineage.parent.empty()) bundle.info.provenance["parent"] = lineage.parent;
  if (!lineage.date.empty()) bundle.info.provenance["date"] = lineage.date;
  nlohmann::ordered_json accuracy = nlohmann::ordered_json::object();
  for (const auto& [field, stage] : stages) {
    accuracy[field] = nlohmann::ordered_json::parse(stage.accuracy());
    bundle.models[field] = stage.model();
    if (auto uncertainty = stage.uncertainty()) bundle.uncertainty[field] = std::move(uncertainty);
  }
  bundle.info.accuracy_json = accuracy.dump();
  bundle.mesh = study.cases.mesh;
  bundle.furnace = study.furnace;
  bundle.guard = model::Guard(study.cases.schema, study.cases.inputs, study.cases.names, study.cases.loads);
  bundle.write(path);
}

}  // namespace elrom::study
