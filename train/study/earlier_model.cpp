#include "earlier_model.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace elrom::study {
namespace {

constexpr std::size_t least_known = 4;  // two folds with something to train and to stop by

using Json = nlohmann::ordered_json;

const Json* entry_of(const Json& candidates, const std::string& name) {
  const auto found =
      std::ranges::find_if(candidates, [&](const Json& entry) { return entry.value("name", "") == name; });
  return found == candidates.end() ? nullptr : &*found;
}

}  // namespace

EarlierModel::EarlierModel(const std::filesystem::path& bundle) {
  const model::BundleReader reader(bundle);
  digest_ = reader.digest();
  info_ = reader.info();
  for (const auto& field : info_.fields) models_[field.name] = reader.model(field.name);
}

methods::WarmStart EarlierModel::warm_start(const std::string& field) const {
  const auto found = models_.find(field);
  return {.parent = digest_, .model = found == models_.end() ? nullptr : found->second};
}

std::vector<std::size_t> EarlierModel::known_rows(const std::string& field, const PresentStudy& now) const {
  const auto accuracy = Json::parse(info_.accuracy_json, nullptr, false);
  const auto settings = info_.provenance.find("settings");
  if (!accuracy.is_object() || !accuracy.contains(field) || settings == info_.provenance.end() ||
      settings->second != now.settings_digest)
    return {};
  const auto& entry = accuracy[field];
  const auto candidates = entry.value("candidates", Json::array());
  const auto* networks = entry_of(candidates, "networks");
  if (networks == nullptr || networks->contains("cases")) return {};
  const auto names = entry.value("known", info_.cases);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < now.cases.size(); ++row) {
    if (std::ranges::find(names, now.cases[row]) == names.end()) continue;
    const auto then = std::ranges::find(info_.cases, now.cases[row]) - info_.cases.begin();
    const auto i = static_cast<std::size_t>(then);
    if (i < info_.case_digests.size() && info_.case_digests[i] == now.case_digests[row]) rows.push_back(row);
  }
  const bool all_there = rows.size() == names.size() && rows.size() >= least_known;
  const bool still_known = static_cast<double>(now.cases.size()) <= growth * static_cast<double>(rows.size());
  return all_there && still_known ? rows : std::vector<std::size_t>();
}

std::vector<LeftOut> EarlierModel::left_out(const std::string& field,
                                            const std::vector<const methods::Method*>& candidates,
                                            std::size_t n_cases) const {
  const auto accuracy = Json::parse(info_.accuracy_json, nullptr, false);
  if (!accuracy.is_object() || !accuracy.contains(field)) return {};
  const auto earlier = accuracy[field].value("candidates", Json::array());
  std::vector<LeftOut> out;
  for (const auto* method : candidates) {
    const auto* entry = entry_of(earlier, method->name());
    if (entry == nullptr || !(*entry)["nrmse"].is_number() || entry->value("weight", 0.0) > 0) continue;
    const LeftOut own{method->name(), (*entry)["nrmse"].get<double>(),
                      entry->value("cases", info_.cases.size())};
    const bool still_known = static_cast<double>(n_cases) <= growth * static_cast<double>(own.n_cases);
    if (still_known) out.push_back(own);
  }
  return out.size() < candidates.size() ? out : std::vector<LeftOut>();
}

}  // namespace elrom::study
