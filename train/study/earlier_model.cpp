#include "earlier_model.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/model/bundle.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::json;

const Json* entry_of(const Json& candidates, const std::string& name) {
  const auto found =
      std::ranges::find_if(candidates, [&](const Json& entry) { return entry.value("name", "") == name; });
  return found == candidates.end() ? nullptr : &*found;
}

}  // namespace

EarlierModel::EarlierModel(const std::filesystem::path& bundle) {
  const model::BundleReader reader(bundle);
  digest_ = reader.digest();
  accuracy_ = reader.info().accuracy_json;
  n_cases_ = reader.info().cases.size();
  for (const auto& field : reader.info().fields) models_[field.name] = reader.model(field.name);
}

methods::WarmStart EarlierModel::warm_start(const std::string& field) const {
  const auto found = models_.find(field);
  return {digest_, found == models_.end() ? nullptr : found->second};
}

std::vector<LeftOut> EarlierModel::left_out(const std::string& field,
                                            const std::vector<const methods::Method*>& candidates,
                                            std::size_t n_cases) const {
  const auto accuracy = Json::parse(accuracy_, nullptr, false);
  if (!accuracy.is_object() || !accuracy.contains(field)) return {};
  const auto earlier = accuracy[field].value("candidates", Json::array());
  double best = std::numeric_limits<double>::infinity();
  for (const auto& entry : earlier)
    if (entry.value("weight", 0.0) > 0 && entry["nrmse"].is_number())
      best = std::min(best, entry["nrmse"].get<double>());

  std::vector<LeftOut> out;
  for (const auto* method : candidates) {
    const auto* entry = entry_of(earlier, method->name());
    if (entry == nullptr || !(*entry)["nrmse"].is_number() || entry->value("weight", 0.0) > 0) continue;
    const LeftOut own{method->name(), (*entry)["nrmse"].get<double>(), entry->value("cases", n_cases_)};
    const bool still_known = static_cast<double>(n_cases) <= growth * static_cast<double>(own.n_cases);
    if (still_known && own.nrmse > (1 + far) * best) out.push_back(own);
  }
  return out.size() < candidates.size() ? out : std::vector<LeftOut>();
}

}  // namespace elrom::study
