#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/ingest/check.hpp"
#include "elrom/io/file_kind.hpp"
#include "value_range.hpp"

namespace elrom::ingest {

std::string to_json(const Checker& checker, std::span<const Finding> findings) {
  using nlohmann::ordered_json;
  auto report = io::json_head<ordered_json>(io::kinds::check);
  report["cases"] = ordered_json::array();
  for (const auto& one : checker.cases()) report["cases"].push_back(one.name);
  report["readings"] = ordered_json::array();
  for (const auto& one : checker.cases()) {
    for (const auto& reading : one.readings)
      report["readings"].push_back(
          {{"case", one.name}, {"kind", reading.check}, {"what", reading.what}, {"value", reading.value}});
  }
  report["findings"] = ordered_json::array();
  std::map<std::string, int> counts{{"note", 0}, {"suspicious", 0}, {"wrong", 0}};
  for (const auto& finding : findings) {
    ++counts[std::string(name_of(finding.severity))];
    ordered_json entry{{"kind", finding.kind},
                       {"severity", name_of(finding.severity)},
                       {"case", finding.case_name},
                       {"quantity", finding.quantity}};
    if (finding.cell >= 0) entry["cell"] = finding.cell;
    if (std::isfinite(finding.value)) {
      entry["value"] = finding.value;
      entry["low"] = number_or_null(finding.low);
      entry["high"] = number_or_null(finding.high);
    }
    entry["message"] = finding.message;
    report["findings"].push_back(std::move(entry));
  }
  report["counts"] = counts;
  // Names come from files and may be no UTF-8.
  return report.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace elrom::ingest
