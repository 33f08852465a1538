#pragma once
// The members of a plain struct, one by one, without naming them: whatever is made of a struct this way (a
// digest, a message) cannot forget one that was added later.
//
// Takes aggregates of up to 16 members, without base classes. Thread rule: pure functions.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "elrom/base/digest.hpp"
#include "elrom/base/random.hpp"

namespace elrom::base {

/// What an aggregate's member may be made from, for counting.
template <std::size_t>
struct AnyMember {
  template <class T>
  operator T() const;  // NOLINT: declared only
};

template <class T, std::size_t... i>
consteval bool has_members(std::index_sequence<i...>) {
  return requires { T{AnyMember<i>{}...}; };
}

inline constexpr std::size_t most_members = 16;

/// Number of members of an aggregate; most_members + 1 when there are more. Counted downwards: with fewer, a
/// member that has no default would be missing.
template <class T, std::size_t n = most_members + 1>
consteval std::size_t n_members() {
  if constexpr (n == 0 || has_members<T>(std::make_index_sequence<n>()))
    return n;
  else
    return n_members<T, n - 1>();
}

/// Calls visit(member) for each member, in the order of declaration; of a changeable value to change them.
template <class T, class Visit>
void for_each_member(T& value, const Visit& visit) {
  constexpr auto n = n_members<std::remove_const_t<T>>();
  static_assert(n >= 1 && n <= most_members, "for_each_member: from 1 to 16 members");
  const auto each = [&](auto&... members) { (visit(members), ...); };
  if constexpr (n == 1) {
    auto& [a] = value;
    each(a);
  } else if constexpr (n == 2) {
    auto& [a, b] = value;
    each(a, b);
  } else if constexpr (n == 3) {
    auto& [a, b, c] = value;
    each(a, b, c);
  } else if constexpr (n == 4) {
    auto& [a, b, c, d] = value;
    each(a, b, c, d);
  } else if constexpr (n == 5) {
    auto& [a, b, c, d, e] = value;
    each(a, b, c, d, e);
  } else if constexpr (n == 6) {
    auto& [a, b, c, d, e, f] = value;
    each(a, b, c, d, e, f);
  } else if constexpr (n == 7) {
    auto& [a, b, c, d, e, f, g] = value;
    each(a, b, c, d, e, f, g);
  } else if constexpr (n == 8) {
    auto& [a, b, c, d, e, f, g, h] = value;
    each(a, b, c, d, e, f, g, h);
  } else if constexpr (n == 9) {
    auto& [a, b, c, d, e, f, g, h, i] = value;
    each(a, b, c, d, e, f, g, h, i);
  } else if constexpr (n == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = value;
    each(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (n == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = value;
    each(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (n == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (n == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (n == 14) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m, o);
  } else if constexpr (n == 15) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m, o, p);
  } else if constexpr (n == 16) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q] = value;
    each(a, b, c, d, e, f, g, h, i, j, k, l, m, o, p, q);
  }
}

/// Adds every member of a value, however deep: numbers, enums, texts, pairs, optionals,
/// lists, maps, matrices, and aggregates of those. What has a key() is added by it, also
/// behind a pointer. A type that is none of these does not compile.
template <class T>
void add_members(Sha256& digest, const T& value) {
  if constexpr (std::is_arithmetic_v<T>) {
    digest.add_value(value);
  } else if constexpr (std::is_enum_v<T>) {
    digest.add_value(static_cast<std::int64_t>(value));
  } else if constexpr (std::is_convertible_v<const T&, std::string_view>) {
    digest.add(std::string_view(value));
  } else if constexpr (std::is_same_v<T, Seed>) {
    digest.add_value(value.value());
  } else if constexpr (requires { value.key(); }) {
    add_members(digest, value.key());
  } else if constexpr (requires { value->key(); }) {
    add_members(digest, value->key());
  } else if constexpr (requires {
                         value.has_value();
                         *value;
                       }) {
    digest.add_value(value.has_value());
    if (value.has_value()) add_members(digest, *value);
  } else if constexpr (requires {
                         value.data();
                         value.rows();
                         value.cols();
                       }) {
    digest.add_value(static_cast<std::int64_t>(value.rows()));
    digest.add_value(static_cast<std::int64_t>(value.cols()));
    digest.add(std::as_bytes(std::span(value.data(), static_cast<std::size_t>(value.size()))));
  } else if constexpr (requires {
                         value.begin();
                         value.size();
                       }) {
    digest.add_value(value.size());
    if constexpr (requires { std::as_bytes(std::span(value.data(), value.size())); } &&
                  std::is_arithmetic_v<typename T::value_type>) {
      digest.add(std::as_bytes(std::span(value.data(), value.size())));
    } else {
      for (const auto& item : value) add_members(digest, item);
    }
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
