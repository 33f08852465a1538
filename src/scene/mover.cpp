#include "elrom/scene/mover.hpp"

#include "elrom/base/error.hpp"
#include "movers.hpp"
#include "walls.hpp"

namespace elrom::scene {
namespace {

class FreeFlight final : public Mover {
 public:
  FreeFlight(const Domain& domain, const MoverSettings& settings) : domain_(domain), settings_(settings) {}
  void advance(State& state, double dt) override {
    fly(state, domain_, settings_.walls, dt, settings_.n_threads);
  }

 private:
  const Domain& domain_;
  MoverSettings settings_;
};

}  // namespace

std::unique_ptr<Mover> make_mover(const Domain& domain, const MoverSettings& settings) {
  switch (settings.collisions) {
    case Collisions::none:
      break;
    case Collisions::dem:
      return make_soft_spheres(domain, settings);
    case Collisions::hel:
      return make_stressed_parcels(domain, settings);
    case Collisions::helscm:
      return make_swept(domain, settings);
    case Collisions::helscm_document:
      return make_proximity(domain, settings);
  }
  return std::make_unique<FreeFlight>(domain, settings);
}

}  // namespace elrom::scene
