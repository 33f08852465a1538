#include "model_kinds.hpp"

#include <vector>

#include "elrom/model/banded_networks.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/model/nearest_model.hpp"
#include "elrom/model/pod_model.hpp"

namespace elrom::model {

// A new kind: include its header and add its line to the table.
std::span<const ModelKind> model_kinds() {
  static const std::vector<ModelKind> kinds = [] {
    std::vector<ModelKind> table{{"networks", BandedNetworks::load}, {"nearest", NearestModel::load},
                                 {"blend", BlendModel::load},        {"scaled", ScaledModel::load},
                                 {"mirror", MirrorModel::load},      {"unfolded", UnfoldedModel::load}};
    for (const std::string& kind : PodModel::kinds()) table.push_back({kind, PodModel::load});
    return table;
  }();
  return kinds;
}

}  // namespace elrom::model
