#pragma once
// Every member of a plain struct changed, one at a time: what carries or tells apart only some of them fails,
// and a member that is added later is tried by itself.

#include <string>
#include <type_traits>
#include <vector>

#include "elrom/base/members.hpp"

namespace elrom::test {

template <class T>
void change(T& value) {
  if constexpr (std::is_same_v<T, bool>)
    value = !value;
  else if constexpr (std::is_enum_v<T>)
    value = static_cast<T>(static_cast<int>(value) + 1);
  else if constexpr (std::is_floating_point_v<T>)
    value += T(1) / 3;
  else if constexpr (std::is_arithmetic_v<T>)
    value += 1;
  else if constexpr (std::is_same_v<T, std::string>)
    value += "?";
  else if constexpr (requires {
                       value.resize(1);
                       value.size();
                     })
    value.resize(value.size() + 1);
  else
    base::for_each_member(value, [](auto& member) { change(member); });
}

/// One copy a member, in which that member is another.
template <class T>
std::vector<T> each_member_changed(const T& value) {
  std::vector<T> changed;
  for (std::size_t i = 0; i < base::n_members<T>(); ++i) {
    changed.push_back(value);
    std::size_t k = 0;
    base::for_each_member(changed.back(), [&](auto& member) {
      if (k++ == i) change(member);
    });
  }
  return changed;
}

}  // namespace elrom::test
