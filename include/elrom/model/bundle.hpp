#pragma once
// Bundle `model.elrom`: everything prediction needs, in one tensor file. Layout in data/FORMATS.md (kind
// "elrom-bundle").

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/model/field_model.hpp"
#include "elrom/model/guard.hpp"
#include "elrom/model/uncertainty.hpp"

namespace elrom::model {

/// What a bundle holds beside its models. `provenance` and `accuracy` are for people and reports.
struct BundleInfo {
  std::string method;  ///< as asked: "auto", "networks", "pod_gp" ...
  std::vector<field::FieldInfo> fields;
  field::InputSchema schema;
  std::vector<std::string> cases;                 ///< training cases
  std::map<std::string, std::string> provenance;  ///< program, store digest, settings digest, created (UTC)
  std::string accuracy_json = "{}";               ///< cross-validated errors by field, kept for display
};

/// A bundle under construction, or read whole.
struct Bundle {
  BundleInfo info;
  field::Mesh mesh;
  Guard guard;
  std::map<std::string, std::shared_ptr<const FieldModel>> models;        ///< by field name
  std::map<std::string, std::shared_ptr<const Uncertainty>> uncertainty;  ///< by field name; may be missing

  void write(const std::filesystem::path& path) const;
};

/// Opens lazily: header and small parts only; a field's model is built from its tensors when asked for.
/// Thread rule: const use from any thread.
class BundleReader {
 public:
  /// @throws InputError for another kind or a newer major version, saying found and expected
  explicit BundleReader(const std::filesystem::path& path);

  [[nodiscard]] const BundleInfo& info() const { return info_; }
  [[nodiscard]] std::size_t n_planes() const { return n_planes_; }
  [[nodiscard]] std::size_t n_columns() const { return n_columns_; }
  [[nodiscard]] const std::string& mesh_digest() const { return mesh_digest_; }
  [[nodiscard]] field::Mesh mesh(bool verify = true) const;
  [[nodiscard]] Guard guard(bool verify = true) const;
  /// Compares the digests of everything that prediction of `fields` reads, on n_threads, so that loading need
  /// not.
  void verify(std::span<const field::FieldInfo> fields, bool with_uncertainty, int n_threads) const;
  /// @param verify compares the digests of the tensors it reads
  [[nodiscard]] std::unique_ptr<FieldModel> model(const std::string& field, bool verify = true) const;
  /// nullptr when the bundle has none for that field
  [[nodiscard]] std::unique_ptr<Uncertainty> uncertainty(const std::string& field, bool verify = true) const;
  [[nodiscard]] const io::TensorFile& file() const { return file_; }
  [[nodiscard]] const std::string& digest() const { return file_.digest(); }

 private:
  io::TensorFile file_;
  BundleInfo info_;
  std::size_t n_planes_ = 0, n_columns_ = 0;
  std::string mesh_digest_;
};

}  // namespace elrom::model
