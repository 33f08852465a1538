#pragma once
// What is in a store, a mesh, a case, a bundle or a prediction, for `elrom-data inspect`: numbers in the
// user's units, as text and as JSON.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "elrom/field/mesh.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::ingest {

/// Keys: kind, n_cases, load {min, max}, mesh, furnace (null: not described), inputs [{name, unit, min, max,
/// mean}], fields [{name, unit, min, mean, max}], cases [{name, load, source ...}], digest.
[[nodiscard]] nlohmann::ordered_json describe_store(const field::SnapshotStore& store);
[[nodiscard]] nlohmann::ordered_json describe_mesh(const field::Mesh& mesh);
[[nodiscard]] nlohmann::ordered_json describe_case(const CfdCase& one);
/// Keys: kind, method, mesh, furnace (null: not described), inputs, fields [{name, unit, model}], cases
/// (those it was trained on), provenance, accuracy, digest.
[[nodiscard]] nlohmann::ordered_json describe_bundle(const model::BundleReader& bundle);

/// Keys: kind, case, load, validity, validity_reason, nearest, method, builds, interval_level (null: not
/// asked for), n_planes, profiles (true: plane averages), inputs [{name, unit, value}], fields [{name, unit,
/// min, mean, max}], bundle_digest.
/// @throws InputError when it is no prediction file, or crashes the HDF5 library
[[nodiscard]] nlohmann::ordered_json describe_prediction(const std::filesystem::path& path);

/// The same in words, for a terminal.
[[nodiscard]] std::string in_words(const nlohmann::ordered_json& description);

}  // namespace elrom::ingest
