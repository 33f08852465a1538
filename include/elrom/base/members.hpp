#pragma once
// The members of a plain struct, one by one, without naming them: whatever is made of a struct this way (a
// digest, a text) cannot forget one that was added later.
//
// Takes aggregates of up to 16 members, without base classes. Thread rule: pure functions.

#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "elrom/base/digest.hpp"

namespace elrom::base {

/// What an aggregate's member may be made from, for counting.
struct AnyMember {
  template <class T>
  operator T() const;  // NOLINT: declared only
};

/// Number of members of an aggregate.
template <class T, class... Members>
consteval std::size_t n_members() {
  if constexpr (requires { T{Members{}..., AnyMember{}}; })
    return n_members<T, Members..., AnyMember>();
  else
    return sizeof...(Members);
}

/// Calls visit(member) for each member, in the order of declaration.
template <class T, class Visit>
void for_each_member(const T& value, const Visit& visit) {
  constexpr auto n = n_members<T>();
  static_assert(n <= 16, "for_each_member: at most 16 members");
  const auto each = [&](const auto&... members) { (visit(members), ...); };
  if constexpr (n == 1) {
    const auto& [a] = value;
    each(a);
  } else if constexpr (n == 2) {
    const auto& [a, b] = value;
    each(a, b);
  } else if constexpr (n == 3) {
    const auto& [a, b, c] = value;
    each(a, b, c);
  } else if constexpr (n == 4) {
    const auto& [a, b, c, d] = value;
    each(a, b, c, d);
  } else if constexpr (n == 5) {
    const auto& [a, b, c, d, e] = value;
    each(a, b, c, d, e);
  } else if constexpr (n == 6) {
    const auto& [a, b, c, d, e, f] = value;
    each(a, b, c, d, e, f);
  } else if constexpr (n == 7) {
    const auto& [a, b, c, d, e, f, g] = value;
    each(a, b, c, d, e, f, g);
  } else if constexpr (n == 8) {
    const auto& [a, b, c, d, e, f, g, h] = value;
    each(a, b, c, d, e, f, g, h);
  } else if constexpr (n == 9) {
    const auto& [a, b, c, d, e, f, g, h, i] = value;
    each(a, b, c, d, e, f, g, h, i);
  } else if constexpr (n == 10) {
    const auto& [a, b, c, d, e, f, g, h, i, j] = value;
    each(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (n == 11) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k] = value;
    each(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (n == 12) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (n == 13) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (n == 14) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m, o);
  } else if constexpr (n == 15) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m, o, p);
  } else if constexpr (n == 16) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q);
  }
}

/// Adds every member of a value, however deep: numbers, enums, texts, pairs, optionals, lists, maps, and
/// aggregates of those. A type that is none of these does not compile.
template <class T>
void add_members(Sha256& digest, const T& value) {
  if constexpr (std::is_arithmetic_v<T>) {
    digest.add_value(value);
  } else if constexpr (std::is_enum_v<T>) {
    digest.add_value(static_cast<std::int64_t>(value));
  } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    digest.add(std::string_view(value));
  } else if constexpr (requires {
                         value.has_value();
                         *value;
                       }) {
    digest.add_value(value.has_value());
    if (value.has_value()) add_members(digest, *value);
  } else if constexpr (requires {
                         value.begin();
                         value.size();
                       }) {
    digest.add_value(value.size());
    for (const auto& item : value) add_members(digest, item);
  } else if constexpr (requires {
                         value.first;
                         value.second;
                       }) {
    add_members(digest, value.first);
    add_members(digest, value.second);
  } else {
    static_assert(std::is_aggregate_v<T>, "add_members: a plain struct");
    for_each_member(value, [&](const auto& member) { add_members(digest, member); });
  }
}

/// Digest of several values, in their order.
template <class... Values>
[[nodiscard]] std::string digest_of_members(const Values&... values) {
  Sha256 digest;
  (add_members(digest, values), ...);
  return digest.hex();
}

}  // namespace elrom::base
