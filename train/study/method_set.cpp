#include "method_set.hpp"

#include <algorithm>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/methods/peers.hpp"
#include "elrom/methods/pod_mlp.hpp"

namespace elrom::study {
namespace {

bool needs_trainer(const std::string& name) {
  const auto* known = methods::find_method(name);
  return known != nullptr && known->needs_trainer;
}

NotBuiltError no_trainer(const std::string& name) {
  return NotBuiltError({.what = "method " + name + " needs LibTorch, which this build left out",
                        .advice = "build with -DELROM_TORCH=ON, or choose another method"});
}

methods::PodMlpOptions pod_mlp_options(const Settings& settings) {
  methods::PodMlpOptions options;
  options.builds = settings.fit.builds;
  options.mirrors = settings.networks.mirrors && settings.symmetry.enabled;
  return options;
}

}  // namespace

MethodSet::MethodSet(const Settings& settings, Toolbox toolbox, const io::StageCache* cache,
                     networks::TrialStore* trials)
    : settings_(settings), toolbox_(std::move(toolbox)), cache_(cache), trials_(trials) {
  if (needs_trainer(settings_.method) && !has_networks()) throw no_trainer(settings_.method);
  for (const auto& name : settings_.peers.methods) {
    if (!is_peer(name)) {
      throw UsageError({.what = "unknown peer '" + name + "'",
                        .where = "peers.methods",
                        .advice = base::name_advice(name, methods::peer_names())});
    }
  }
}

std::unique_ptr<methods::Method> MethodSet::make(const std::string& name) const {
  if (name == "pod_mlp") return methods::make_pod_mlp(toolbox_.trainer, pod_mlp_options(settings_));
  if (is_peer(name)) return methods::make_peer(name);
  if (name == "kernel") return methods::make_kernel_method();
  throw UsageError({.what = "unknown method '" + name + "'", .where = "method"});
}

const methods::Method& MethodSet::get(const std::string& name) {
  if (needs_trainer(name) && !has_networks()) throw no_trainer(name);
  if (name == "networks") return networks();
  auto& method = made_[name];
  if (!method) method = make(name);
  return *method;
}

methods::NetworksMethod& MethodSet::networks() {
  auto& method = made_["networks"];
  if (!method)
    method = std::make_unique<methods::NetworksMethod>(settings_, toolbox_.trainer, cache_, trials_);
  return static_cast<methods::NetworksMethod&>(*method);
}

std::vector<const methods::Method*> MethodSet::candidates() {
  std::vector<const methods::Method*> methods{&get("kernel")};
  for (const auto& name : peers()) methods.push_back(&get(name));
  if (settings_.peers.networks && has_networks()) methods.push_back(&get("networks"));
  return methods;
}

std::vector<std::string> MethodSet::peers() const {
  std::vector<std::string> names;
  for (const auto& name : settings_.peers.methods)
    if (has_networks() || !needs_trainer(name)) names.push_back(name);
  return names;
}

std::vector<std::string> MethodSet::bundles() const {
  std::vector<std::string> names{settings_.method};
  for (const auto& name : peers())
    if (name != settings_.method) names.push_back(name);
  if (settings_.peers.networks && has_networks() && settings_.method != "networks")
    names.push_back("networks");
  return names;
}

bool MethodSet::is_peer(const std::string& name) const {
  return std::ranges::find(methods::peer_names(), name) != methods::peer_names().end();
}

bool MethodSet::trains_networks(const std::string& name) const {
  return has_networks() && (name == "networks" || (name == "auto" && settings_.peers.networks));
}

std::vector<const methods::Method*> MethodSet::candidates_of(const std::string& name) {
  return name == "auto" ? candidates() : std::vector{&get(name)};
}

}  // namespace elrom::study
