#pragma once
// The names of an enumeration, as files, settings and command
// lines spell them: one table serves both directions.
//
//   constexpr base::EnumNames<Colour, 2> colours{"colour", {{Colour::red, "red"}, {Colour::blue, "blue"}}};
//   colours.name(Colour::red);    // "red"
//   colours.value("blu");         // InputError: unknown colour: found 'blu'; did you mean 'blue'?
//
// Thread rule: pure functions.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::base {

template <class Enum, std::size_t n>
struct EnumNames {
  struct Entry {
    Enum value;
    std::string_view name;
  };
  std::string_view what;  ///< for messages: "activation"
  Entry entries[n];

  [[nodiscard]] constexpr std::string_view name(Enum value) const {
    for (const Entry& entry : entries)
      if (entry.value == value) return entry.name;
    check(false, "an enumeration's value without a name");
    return {};
  }
  [[nodiscard]] constexpr std::optional<Enum> find(std::string_view name) const {
    for (const Entry& entry : entries)
      if (entry.name == name) return entry.value;
    return std::nullopt;
  }
  /// @throws Fault for a name that is not in the table, with the nearest one
  template <class Fault = InputError>
  [[nodiscard]] Enum value(std::string_view name) const {
    if (const auto found = find(name)) return *found;
    throw Fault(Problem{.what = "unknown " + std::string(what),
                        .found = "'" + std::string(name) + "'",
                        .advice = name_advice(name, names())});
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Entry& entry : entries) all.emplace_back(entry.name);
    return all;
  }
};

}  // namespace elrom::base
