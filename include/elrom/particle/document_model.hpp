#pragma once
// The source's surrogate: boosted trees on the six velocity components give the six after the collision. Slow
// pairs have trees of their own. It knows no normal and no sizes, so it makes and loses momentum and energy.

#include <optional>

#include "elrom/math/standardiser.hpp"
#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/trees.hpp"

namespace elrom::particle {

/// (n, 6): velocity of sphere 1, then of sphere 2, m/s.
[[nodiscard]] Table six_velocities(const Motion& motion);

/// Six velocity components before to six after, m/s.
struct DocumentPart {
  math::Standardiser inputs;  ///< (6), of the training set
  Trees trees;                ///< 6 inputs, 6 outputs

  [[nodiscard]] Table evaluate(const Table& velocities) const;
};

class DocumentModel final : public CollisionModel {
 public:
  struct Low {
    double speed;  ///< m/s: this part is asked where neither sphere is faster
    DocumentPart part;
  };
  /// @throws InputError for parts that do not take and give six numbers, a scale or speed that is not positive
  explicit DocumentModel(DocumentPart full, std::optional<Low> low = {},
                         const std::string& where = "document");

  [[nodiscard]] SurrogateKind kind() const override { return SurrogateKind::document; }
  [[nodiscard]] std::string text() const override;
  void impulses(const Pairs& pairs, Impulses& impulses) const override;
  /// The velocities after, whatever the normal: what the source's figures are made of. @param velocities (n, 6)
  [[nodiscard]] Table velocities_after(const Table& velocities) const;

  /// Tensors under "document/...".
  void write(io::TensorFile& file) const override;
  [[nodiscard]] static std::unique_ptr<DocumentModel> read(const io::TensorFile& file);

 private:
  DocumentPart full_;
  std::optional<Low> low_;
};

}  // namespace elrom::particle
