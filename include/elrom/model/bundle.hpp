#pragma once
// Bundle `model.elrom`: everything prediction needs, in one tensor
// file. Layout in data/FORMATS.md (kind "elrom-bundle").

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/furnace.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/field/planes.hpp"
#include "elrom/model/audit.hpp"
#include "elrom/model/field_model.hpp"
#include "elrom/model/guard.hpp"
#include "elrom/model/uncertainty.hpp"

namespace elrom::model {

/// What a bundle holds beside its models. `provenance` and `accuracy` are for people and reports.
struct BundleInfo {
  std::string method;  ///< as asked: "auto", "networks", "pod_gp" ...
  std::vector<field::FieldInfo> fields;
  field::InputSchema schema;
  std::vector<std::string> cases;  ///< training cases
  /// SHA-256 of each over name, inputs and fields (SnapshotStore::digest); empty: before 1.2
  std::vector<std::string> case_digests;
  /// program, digests of store and settings; from 1.2 also the digest of the parent, the bundle that it was
  /// made to take the place of, and the date it was told; what is not known is left out
  std::map<std::string, std::string> provenance;
  /// Of the study, as TOML; what says how and where it runs is at its default. Empty: before 1.2
  std::string settings;
  std::vector<UsualFigure> usual_audit;  ///< of the training cases' audits; empty: not known, before 1.3
  std::string accuracy_json = "{}";      ///< cross-validated errors by field, kept for display
};

/// A bundle under construction, or read whole.
struct Bundle {
  BundleInfo info;
  field::Mesh mesh;
  Guard guard;
  std::optional<field::Furnace> furnace;  ///< of the training cases, where somebody described it
  std::map<std::string, std::shared_ptr<const FieldModel>> models;        ///< by field name
  std::map<std::string, std::shared_ptr<const Uncertainty>> uncertainty;  ///< by field name; may be missing

  void write(const std::filesystem::path& path) const;
};

/// What of the mesh is to be read.
struct MeshPart {
  field::Planes planes;      ///< the others are left out, their points are not
  bool with_corners = true;  ///< false: centres and volumes only
  int n_threads = 1;
};

/// Opens lazily: header and small parts only; a field's model is built from its tensors when asked for.
/// Thread rule: const use from any thread.
class BundleReader {
 public:
  /// @throws InputError for another kind or a newer major version, saying found and expected
  /// @param verify with on_use, everything that is read from here on is compared with its digest
  explicit BundleReader(const std::filesystem::path& path, io::Verify verify = io::Verify::on_use);

  [[nodiscard]] const BundleInfo& info() const { return info_; }
  [[nodiscard]] std::size_t n_planes() const { return n_planes_; }
  [[nodiscard]] std::size_t n_columns() const { return n_columns_; }
  [[nodiscard]] const std::string& mesh_digest() const { return mesh_digest_; }
  /// @throws InputError for a mesh that is broken, UsageError when it lacks a plane of `part`
  [[nodiscard]] field::Mesh mesh(const MeshPart& part = {}) const;
  [[nodiscard]] Guard guard() const;
  /// Parsed when asked for. Nothing in bundles before 1.1, or of cases whose furnace nobody described.
  [[nodiscard]] std::optional<field::Furnace> furnace() const;
  [[nodiscard]] std::unique_ptr<FieldModel> model(const std::string& field, const Wanted& wanted = {}) const;
  /// nullptr when the bundle has none for that field
  [[nodiscard]] std::unique_ptr<Uncertainty> uncertainty(const std::string& field) const;
  [[nodiscard]] const io::TensorFile& file() const { return file_; }
  [[nodiscard]] const std::string& digest() const { return file_.digest(); }

 private:
  io::TensorFile file_;
  BundleInfo info_;
  std::size_t n_planes_ = 0, n_columns_ = 0;
  std::string mesh_digest_;
};

}  // namespace elrom::model
