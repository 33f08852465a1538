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
    {"pod_mlp", "POD + MLP", true, true, 7},
    {"kernel", "kernel", false, false, 8},
}};

template <class Condition>
std::vector<std::string> names_where(const Condition& holds) {
  std::vector<std::string> names;
  for (const auto& row : table)
    if (holds(row)) names.emplace_back(row.name);
  return names;
}

}  // namespace

std::span<const MethodInfo> catalogue() { return table; }

const MethodInfo* find_method(std::string_view name) {
  const auto found =
      std::ranges::find(table, name, [](const auto& row) { return std::string_view(row.name); });
  return found == table.end() ? nullptr : &*found;
}

std::vector<std::string> method_names() {
  return names_where([](const MethodInfo&) { return true; });
}

const std::vector<std::string>& peer_names() {
  static const auto names = names_where([](const MethodInfo& row) { return row.peer; });
  return names;
}

const std::vector<std::string>& closed_form_peers() {
  static const auto names = names_where([](const MethodInfo& row) { return row.peer && !row.needs_trainer; });
  return names;
}

}  // namespace elrom::methods
