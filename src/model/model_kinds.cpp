#include "model_kinds.hpp"

#include <vector>

#include "elrom/model/banded_networks.hpp"

namespace elrom::model {

// A new kind: include its header and add its line to the table.
std::span<const ModelKind> model_kinds() {
  static const std::vector<ModelKind> kinds = {
      {"networks", BandedNetworks::load},
  };
  return kinds;
}

}  // namespace elrom::model
