// Fields of gas that others computed: each is read as it is stored, and interpolated as its own kind wants
// it.
#include "frozen_gas.hpp"

#include "elrom/base/error.hpp"
#include "elrom/foam/foam_case.hpp"
#include "elrom/foam/foam_file.hpp"
#include "elrom/foam/foam_mesh.hpp"

namespace elrom::scene {
namespace {

namespace fs = std::filesystem;

constexpr const char* scene_file = "scene.toml";
constexpr const char* checkpoint_file = "checkpoint.elrom";

// The gas of a run's last checkpoint, on its own staggered grid.
class SavedGas final : public GasField {
 public:
  explicit SavedGas(const fs::path& folder)
      : settings_(read_scene(folder / scene_file)), domain_(settings_.domain()) {
    if (settings_.gas != "coupled")
      throw InputError(Problem{.what = "the run has no gas field",
                               .where = (folder / scene_file).string(),
                               .found = "gas.model = \"" + settings_.gas + "\"",
                               .expected = "\"coupled\""});
    flow_ = flow_of(settings_, domain_, std::make_shared<CellGrid>(domain_, settings_.cell));
    const auto file = io::TensorFile::open(folder / checkpoint_file, io::Verify::on_use);
    io::check_kind(file, io::kinds::scene_checkpoint);
    flow_->load(file);
  }
  void velocity(const Vectors& place, std::size_t first, std::span<Vec> velocities) const override {
    for (std::size_t k = 0; k < velocities.size(); ++k) {
      std::array<Shares, 3> faces;
      for (std::size_t a = 0; a < 3; ++a) faces[a] = flow_->grid().faces(get(place, first + k), a);
      velocities[k] = read(flow_->velocity(), faces);
    }
  }
  [[nodiscard]] std::size_t bytes() const override { return flow_->bytes(); }

 private:
  SceneSettings settings_;
  Domain domain_;
  std::unique_ptr<GasFlow> flow_;
};

std::unique_ptr<GasField> foam_gas(const fs::path& folder, int n_threads) {
  const auto found = foam::read_foam_case(folder);
  const auto mesh = foam::read_poly_mesh(folder / "constant" / "polyMesh");
  return frozen_gas(mesh.centre,
                    foam::read_internal_field(found.fields / found.with_gas("U"), mesh.volume.size(), 3),
                    n_threads);
}

}  // namespace

std::unique_ptr<GasFlow> flow_of(const SceneSettings& settings, const Domain& domain,
                                 std::shared_ptr<CellGrid> grid) {
  std::vector<GasInlet> inlets;
  for (const auto& inlet : settings.gas_inlets) inlets.push_back({inlet.side, inlet.velocity});
  return std::make_unique<GasFlow>(domain, std::move(grid), settings.gas_properties, inlets);
}

std::unique_ptr<GasField> frozen_gas_of(const fs::path& path, int n_threads) {
  if (!fs::is_directory(path)) return frozen_gas(path, n_threads);
  if (fs::exists(path / checkpoint_file)) return std::make_unique<SavedGas>(path);
  return foam_gas(path, n_threads);
}

}  // namespace elrom::scene
