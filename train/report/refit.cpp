#include "refit.hpp"

#include <algorithm>
#include <map>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/methods/peers.hpp"

namespace elrom::report {

std::vector<std::string> refittable_methods() {
  auto names = methods::closed_form_peers();
  names.push_back("kernel");
  return names;
}

std::string method_of(const model::BundleReader& bundle) {
  const auto known = refittable_methods();
  std::map<std::string, int> votes;
  for (const auto& info : bundle.info().fields) {
    const auto kind = bundle.model(info.name)->kind();
    if (std::find(known.begin(), known.end(), kind) != known.end()) ++votes[kind];
  }
  const auto most = std::max_element(votes.begin(), votes.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == votes.end() ? "kernel" : most->first;
}

std::unique_ptr<methods::Method> make_method(const std::string& name) {
  if (name == "kernel") return methods::make_kernel_method();
  const auto known = refittable_methods();
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw UsageError({.what = "no method '" + name + "' that a learning curve can fit",
                      .advice = base::name_advice(name, known)});
  return methods::make_peer(name);
}

}  // namespace elrom::report
