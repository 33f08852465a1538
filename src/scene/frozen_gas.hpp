#pragma once
// A scene's gas from what its settings and files tell. Internal.

#include "elrom/scene/gas.hpp"
#include "elrom/scene/gas_flow.hpp"
#include "elrom/scene/scene_settings.hpp"

namespace elrom::scene {

/// The coupled gas of a scene, at rest. @param domain lives longer
[[nodiscard]] std::unique_ptr<GasFlow> flow_of(const SceneSettings& settings, const Domain& domain,
                                               std::shared_ptr<CellGrid> grid);

/// A prediction (.hdf), a case of OpenFOAM (its latest time folder with a gas velocity), or the folder that
/// elrom-simulate wrote for a scene with a coupled gas. @throws InputError
[[nodiscard]] std::unique_ptr<GasField> frozen_gas_of(const std::filesystem::path& path, int n_threads);

}  // namespace elrom::scene
