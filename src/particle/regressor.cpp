#include "elrom/particle/regressor.hpp"

#include <array>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/particle/chebyshev.hpp"
#include "elrom/particle/network_regressor.hpp"
#include "elrom/particle/trees.hpp"

namespace elrom::particle {
namespace {

using Read = std::unique_ptr<Regressor> (*)(const io::TensorFile& file, const std::string& prefix);

template <class Kind>
std::unique_ptr<Regressor> read_as(const io::TensorFile& file, const std::string& prefix) {
  return Kind::read(file, prefix);
}

// A new kind: add its line to the table.
struct RegressorKind {
  const char* name;
  Read read;
};
constexpr std::array regressor_kinds{RegressorKind{"trees", read_as<Trees>},
                                     RegressorKind{"chebyshev", read_as<Chebyshev>},
                                     RegressorKind{"network", read_as<NetworkRegressor>}};

}  // namespace

std::unique_ptr<Regressor> read_regressor(const io::TensorFile& file, const std::string& prefix) {
  const auto& kind = file.text(prefix + "/kind");
  std::vector<std::string> names;
  for (const auto& entry : regressor_kinds) {
    if (kind == entry.name) return entry.read(file, prefix);
    names.emplace_back(entry.name);
  }
  throw InputError({.what = "unknown kind of regressor '" + kind + "'",
                    .where = file.where() + ":" + prefix,
                    .advice = base::name_advice(kind, names) + "; a newer ELROM may have written it"});
}

}  // namespace elrom::particle
