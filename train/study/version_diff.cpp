#include "elrom/study/version_diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "elrom/base/text.hpp"
#include "elrom/model/bundle.hpp"

namespace elrom::study {
namespace {

/// Value by "[section] key" of settings as to_toml() writes them: one a line.
std::map<std::string, std::string> by_key(const std::string& toml) {
  std::map<std::string, std::string> values;
  std::string section;
  for (const auto& line : base::split(toml, '\n')) {
    if (line.starts_with("[")) section = line + " ";
    const auto equals = line.find(" = ");
    if (equals != std::string::npos) values[section + line.substr(0, equals)] += line.substr(equals + 3);
  }
  return values;
}

std::vector<std::string> changed_settings(const std::string& a, const std::string& b) {
  const auto before = by_key(a), after = by_key(b);
  std::vector<std::string> changes;
  for (const auto& [key, value] : before) {
    const auto found = after.find(key);
    const auto now = found == after.end() ? "not set" : found->second;
    if (now != value) changes.push_back(key + " = " + value + " -> " + now);
  }
  for (const auto& [key, value] : after)
    if (!before.contains(key)) changes.push_back(key + " = not set -> " + value);
  return changes;
}

std::map<std::string, std::string> digests_of(const model::BundleInfo& info) {
  std::map<std::string, std::string> digests;
  for (std::size_t i = 0; i < info.cases.size(); ++i)
    digests[info.cases[i]] = info.case_digests.empty() ? "" : info.case_digests[i];
  return digests;
}

/// Kind and error of each field; of a blend, its members.
void tell_fields(const model::BundleReader& bundle, bool is_a,
                 std::map<std::string, FieldDifference>& fields) {
  const auto accuracy = nlohmann::json::parse(bundle.info().accuracy_json, nullptr, false);
  for (const auto& info : bundle.info().fields) {
    auto& one = fields.try_emplace(info.name, FieldDifference{info.name, "", "", NAN, NAN}).first->second;
    std::vector<std::string> members;
    double nrmse = NAN;
    if (accuracy.is_object() && accuracy.contains(info.name)) {
      const auto& entry = accuracy[info.name];
      if (entry.contains("nrmse") && entry["nrmse"].is_number()) nrmse = entry["nrmse"].get<double>();
      for (const auto& candidate : entry.value("candidates", nlohmann::json::array()))
        if (candidate.value("weight", 0.0) > 0) members.push_back(candidate.value("name", ""));
    }
    (is_a ? one.method_a : one.method_b) =
        members.empty() ? bundle.model(info.name)->kind() : base::join(members, " + ");
    (is_a ? one.nrmse_a : one.nrmse_b) = nrmse;
  }
}

std::string shown(double nrmse) { return std::isfinite(nrmse) ? base::rounded(nrmse, 3) : "not known"; }

std::string list(const std::string& what, const std::vector<std::string>& names) {
  if (names.empty()) return "";
  return fmt::format("{} {} {}: {}\n", names.size(), names.size() == 1 ? "case" : "cases", what,
                     base::join(names, ", "));
}

}  // namespace

BundleDifference difference_of(const std::filesystem::path& a, const std::filesystem::path& b) {
  const model::BundleReader before(a), after(b);
  const auto cases_a = digests_of(before.info()), cases_b = digests_of(after.info());
  BundleDifference difference;
  difference.knows_content = !before.info().case_digests.empty() && !after.info().case_digests.empty();
  for (const auto& [name, digest] : cases_b) {
    const auto found = cases_a.find(name);
    if (found == cases_a.end())
      difference.added.push_back(name);
    else if (difference.knows_content && found->second != digest)
      difference.changed.push_back(name);
  }
  for (const auto& [name, digest] : cases_a)
    if (!cases_b.contains(name)) difference.removed.push_back(name);
  difference.knows_settings = !before.info().settings.empty() && !after.info().settings.empty();
  if (difference.knows_settings)
    difference.settings = changed_settings(before.info().settings, after.info().settings);
  std::map<std::string, FieldDifference> fields;
  tell_fields(before, true, fields);
  tell_fields(after, false, fields);
  for (auto& [name, one] : fields) difference.fields.push_back(std::move(one));
  return difference;
}

std::string in_words(const BundleDifference& difference) {
  std::string text = list("added", difference.added) + list("removed", difference.removed) +
                     list("with other values", difference.changed);
  if (text.empty()) text = "the same cases\n";
  if (!difference.knows_content) text += "whether cases of one name changed is not known: an older bundle\n";
  if (!difference.knows_settings)
    text += "settings are not known: an older bundle\n";
  else if (difference.settings.empty())
    text += "the same settings\n";
  for (const auto& change : difference.settings) text += "setting " + change + "\n";
  text += fmt::format("{:<24} {:>9} {:>9}  {}\n", "field", "A", "B", "NRMSE, cross-validated; method");
  for (const auto& one : difference.fields) {
    const auto method = one.method_a == one.method_b ? one.method_a : one.method_a + " -> " + one.method_b;
    text +=
        fmt::format("{:<24} {:>9} {:>9}  {}\n", one.field, shown(one.nrmse_a), shown(one.nrmse_b), method);
  }
  return text;
}

}  // namespace elrom::study
