#pragma once
// Stages of one method, field by field, put together into a bundle. Internal to the study.

#include <optional>

#include "elrom/field/furnace.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/methods/method.hpp"
#include "elrom/model/audit.hpp"
#include "field_stage.hpp"

namespace elrom::study {

struct StudyBundle {
  std::string method;
  std::vector<field::FieldInfo> fields;
  const field::CaseSet& cases;
  std::optional<field::Furnace> furnace;
  std::string store_digest, settings_digest;
};

/// What a bundle tells of where it comes from, and what its content does not depend on.
struct Lineage {
  std::vector<std::string> case_digests;
  std::string settings;      ///< TOML
  std::string date, parent;  ///< empty: not told, none
  std::vector<model::UsualFigure> usual_audit;
};

using FieldStages = std::map<std::string, FieldStage>;

/// Digest of what the bundle is made of; of its stages, by their inputs. No time of day, so that the
/// same study gives the same bytes, and no lineage, so that a second run finds what the first one made.
[[nodiscard]] std::string content_of(const StudyBundle& bundle, const FieldStages& stages);

/// Whether there is a whole bundle of this content.
[[nodiscard]] bool holds_content(const std::filesystem::path& path, const std::string& content);

/// Of the audits of these cases; nothing where nobody described the furnace. Reads their fields.
[[nodiscard]] std::vector<model::UsualFigure> usual_audit_of(const field::SnapshotStore& store,
                                                             std::span<const std::size_t> rows);

/// Leaves a bundle alone that already holds exactly this.
void write_study_bundle(const std::filesystem::path& path, const StudyBundle& bundle, const Lineage& lineage,
                        const FieldStages& stages);

}  // namespace elrom::study
