#include "elrom/methods/catalogue.hpp"

#include <algorithm>
#include <array>

namespace elrom::methods {
namespace {

constexpr std::array<MethodInfo, 8> table{{
    {"networks", "networks", false, true, 6},
    {"nearest", "nearest case", true, false, 1},
    {"linear", "linear", true, false, 2},
    {"pod_gp", "POD + GP", true, false, 4},
    {"pod_gp_per_mode", "POD + GP per mode", true, false, 5},
    {"pod_rbf", "POD + RBF", true, false, 3},
    {"pod_mlp", "POD + MLP", false, true, 7},
    {"kernel", "kernel", false, false, 8},
}};

}  // namespace

std::span<const MethodInfo> catalogue() { return table; }

const MethodInfo* find_method(std::string_view name) {
  const auto found =
      std::ranges::find(table, name, [](const auto& row) { return std::string_view(row.name); });
  return found == table.end() ? nullptr : &*found;
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

const std::vector<std::string>& peer_names() {
  static const auto names = [] {
    std::vector<std::string> peers;
    for (const auto& row : table)
      if (row.peer) peers.emplace_back(row.name);
    return peers;
  }();
  return names;
}

}  // namespace elrom::methods
