#pragma once
// The bundle's description as JSON text; internal to model.

#include <string>
#include <string_view>

#include "elrom/model/bundle.hpp"

namespace elrom::model {

/// Where a bundle keeps a field's model and its uncertainty.
inline std::string field_prefix(const std::string& field) { return "fields/" + field; }
inline std::string uncertainty_prefix(const std::string& field) { return "uncertainty/" + field; }

struct BundleDescription {
  BundleInfo info;
  std::size_t n_planes = 0, n_columns = 0;
  std::string mesh_digest;
};

[[nodiscard]] std::string to_json(const BundleDescription& description);
/// @throws InputError naming `where` for anything missing or of another type
[[nodiscard]] BundleDescription bundle_description(const std::string& json, const std::string& where);

}  // namespace elrom::model
