#include "refit.hpp"

#include <algorithm>
#include <map>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/study/peers.hpp"

namespace elrom::report {
namespace {

bool can_fit(const std::string& name) {
  const auto& names = study::peer_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::string method_of(const model::BundleReader& bundle) {
  std::map<std::string, int> votes;
  for (const auto& info : bundle.info().fields) {
    const auto kind = bundle.model(info.name, false)->kind();
    if (can_fit(kind)) ++votes[kind];
  }
  const auto most = std::max_element(votes.begin(), votes.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == votes.end() ? "pod_gp" : most->first;
}

std::unique_ptr<study::Method> make_method(const std::string& name, const StudyFiles&, study::CaseSet&) {
  if (!can_fit(name))
    throw UsageError({.what = "no method '" + name + "' that a learning curve can fit",
                      .advice = base::name_advice(name, study::peer_names())});
  return study::make_peer(name);
}

}  // namespace elrom::report
