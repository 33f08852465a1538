#pragma once
// Stages of one method, field by field, put together into a bundle. Internal to the study.

#include <optional>

#include "elrom/field/furnace.hpp"
#include "elrom/methods/method.hpp"
#include "field_stage.hpp"

namespace elrom::study {

struct StudyBundle {
  std::string method;
  std::vector<field::FieldInfo> fields;
  const field::CaseSet& cases;
  std::optional<field::Furnace> furnace;
  std::string store_digest, settings_digest;
};

/// Leaves a bundle alone that already holds exactly this.
void write_study_bundle(const std::filesystem::path& path, const StudyBundle& bundle,
                        const std::map<std::string, FieldStage>& stages);

}  // namespace elrom::study
