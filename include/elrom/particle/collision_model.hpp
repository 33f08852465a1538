#pragma once
// What a collision does, learned or in closed form, behind one seam: pairs as they touch in, impulses out.
//
//   document  the source's: trees on the six velocity components give the six after the collision; no
//             normal, no sizes. Makes and loses momentum and energy; kept to be compared with.
//   frame     ours: in the frame of the collision (normal, slip) a few dimensionless numbers give the
//             impulse. Momentum is exact, rotated pairs give rotated impulses, energy never grows.
//   exact     hard spheres with friction (Walton 1993), the closed form.

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "elrom/base/enum_names.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/particle/contact_law.hpp"
#include "elrom/particle/pairs.hpp"
#include "elrom/particle/protocol.hpp"

namespace elrom::particle {

enum class SurrogateKind { document, frame, exact };
inline constexpr base::EnumNames<SurrogateKind, 3> surrogate_names{"surrogate",
                                                                   {{SurrogateKind::document, "document"},
                                                                    {SurrogateKind::frame, "frame"},
                                                                    {SurrogateKind::exact, "exact"}}};

/// What a collision gives each sphere: linear, N s, and about its own centre, N m s.
struct Impulses {
  Impulses() = default;
  explicit Impulses(std::size_t n);  ///< all zero
  /// Values are lost where the size changes.
  void resize(std::size_t n);
  Components linear_1, linear_2;
  Components angular_1, angular_2;
};

/// Thread rule: const use from any thread.
class CollisionModel {
 public:
  virtual ~CollisionModel() = default;
  [[nodiscard]] virtual SurrogateKind kind() const = 0;
  /// For people: "frame, chebyshev".
  [[nodiscard]] virtual std::string text() const = 0;
  /// Pairs that part, or whose numbers are not finite, get none.
  /// @param impulses overwritten, and sized to the pairs
  virtual void impulses(const Pairs& pairs, Impulses& impulses) const = 0;
  /// Its tensors; the bundle adds law and protocol.
  virtual void write(io::TensorFile& file) const = 0;
};

/// The motion that these impulses leave.
[[nodiscard]] Motion apply(const Pairs& pairs, const Impulses& impulses);

/// A model with what it was learned from: the file
/// `collision.elrom` (data/FORMATS.md, kind "elrom-collision").
struct CollisionBundle {
  std::shared_ptr<const CollisionModel> model;
  Protocol protocol;
  ContactLaw law;
  std::map<std::string, std::string> provenance = {};
  std::string accuracy_json = "{}";  ///< errors on the test pairs, kept for display

  void write(const std::filesystem::path& path) const;
  /// @throws InputError
  [[nodiscard]] static CollisionBundle read(const std::filesystem::path& path);
};

}  // namespace elrom::particle
