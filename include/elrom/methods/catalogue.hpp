#pragma once
// The methods by name. Settings, reports and refusals go by this one table; what makes them is peers.hpp and,
// in a study, MethodSet.
//
// Thread rule: constants.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace elrom::methods {

struct MethodInfo {
  const char* name;    ///< as in study.toml and in the names of bundles
  const char* label;   ///< for tables and charts
  bool peer;           ///< a simple one, fitted without mirror images as a user would run it (peers.hpp)
  bool needs_trainer;  ///< trains networks
  int place;           ///< in tables and in the colours of charts, from 1
};

[[nodiscard]] std::span<const MethodInfo> catalogue();
[[nodiscard]] const MethodInfo* find_method(std::string_view name);  ///< nullptr: none of ours
[[nodiscard]] std::vector<std::string> method_names();
[[nodiscard]] const std::vector<std::string>& peer_names();
/// Those that need no trainer: what make_peer() makes.
[[nodiscard]] const std::vector<std::string>& closed_form_peers();

}  // namespace elrom::methods
