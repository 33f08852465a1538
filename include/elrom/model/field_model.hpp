#pragma once
// Every predictor of one field, network or peer, is a
// FieldModel: boundary conditions in, planes of cells out.
//
// Non-goals: training (train/study), several fields at once (Predictor), units at the edges.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/field/planes.hpp"
#include "elrom/io/tensor_file.hpp"

namespace elrom::model {

/// Scratch memory of one prediction thread: grows on first use and is reused
/// afterwards, so that a predictor allocates nothing after its first call. Used
/// like a stack; spans stay valid until the Frame that took them ends.
class Workspace {
 public:
  class Frame {
   public:
    explicit Frame(Workspace& workspace)
        : workspace_(workspace), mark_block_(workspace.block_), mark_used_(workspace.used_) {}
    ~Frame() {
      workspace_.block_ = mark_block_;
      workspace_.used_ = mark_used_;
    }
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

   private:
    Workspace& workspace_;
    std::size_t mark_block_, mark_used_;
  };
  /// n floats, 64-byte aligned, not initialised.
  [[nodiscard]] std::span<float> floats(std::size_t n);

 private:
  struct Block {
    std::unique_ptr<float[], void (*)(float*)> data;
    std::size_t size;
  };
  std::vector<Block> blocks_;
  std::size_t block_ = 0, used_ = 0;
};

/// What is asked of a model.
struct Query {
  std::span<const double> inputs;        ///< boundary conditions, SI, (n_inputs)
  std::span<const std::int32_t> planes;  ///< numbers of the planes asked for, ascending, (n_query_planes)
  bool best_build_only = false;          ///< the best build instead of the mean of all builds
};

/// Thread rule: const use from any number of threads, each with a Workspace of its own.
class FieldModel {
 public:
  virtual ~FieldModel() = default;

  /// "nearest", "linear", "pod_gp", "networks" ... as in study.toml and in the bundle.
  [[nodiscard]] virtual std::string kind() const = 0;
  /// What it takes and gives; the same for every part of a composite.
  [[nodiscard]] virtual std::size_t n_inputs() const = 0;
  [[nodiscard]] virtual std::size_t n_planes() const = 0;
  [[nodiscard]] virtual std::size_t n_columns() const = 0;

  /// Field values in SI. Results for a plane do not depend on which other planes are asked for, to the bit.
  /// @param values (planes.size() * n_columns), plane by plane
  /// @param spread standard deviation the model itself knows of
  /// (ensemble, kriging variance), same shape; may be empty
  virtual void predict(const Query& query, std::span<float> values, std::span<float> spread,
                       Workspace& workspace) const = 0;

  /// The model as it would be had training case `i_case` (in the bundle's order) never been there, with its
  /// hyperparameters and modes kept; nullptr: there is no closed form for it.
  [[nodiscard]] virtual std::unique_ptr<FieldModel> without_case(std::size_t /*i_case*/) const {
    return nullptr;
  }

  /// Puts tensors under "<prefix>/..." and the description as
  /// JSON text under `prefix` (its "kind" names the reader).
  virtual void save(io::TensorFile& file, const std::string& prefix) const = 0;
};

/// What of a model is to be loaded: predictions of these planes, by these builds. The rest of the file stays
/// unread where the model's kind allows it.
struct Wanted {
  field::Planes planes;
  bool best_build_only = false;
};

/// Reads what save() wrote, or a part of it that answers queries for that part and no other.
/// @throws InputError for an unknown kind or parts that do not fit together, naming file and tensor; that the
/// whole fits a mesh and inputs is for the caller to see
[[nodiscard]] std::unique_ptr<FieldModel> load_field_model(const io::TensorFile& file,
                                                           const std::string& prefix,
                                                           const Wanted& wanted = {});

}  // namespace elrom::model
