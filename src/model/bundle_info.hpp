#pragma once
// The bundle's description as JSON text; internal to model.

#include <string>

#include "elrom/model/bundle.hpp"

namespace elrom::model {

struct BundleDescription {
  BundleInfo info;
  std::size_t n_planes = 0, n_columns = 0;
  std::string mesh_digest;
};

[[nodiscard]] std::string to_json(const BundleDescription& description);
/// @throws InputError naming `where` for anything missing or of another type
[[nodiscard]] BundleDescription bundle_description(const std::string& json, const std::string& where);

}  // namespace elrom::model
