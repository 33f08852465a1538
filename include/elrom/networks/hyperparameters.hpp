#pragma once
// What the search looks for, and the one list of it. Stage files, the search space, the trial store,
// checkpoints and messages between processes go through the list: a new hyperparameter is a member, its name,
// and the values that it is searched over (search_space.cpp).
//
// The search and its store serve any such struct: a plain one of numbers and enums with `names`, one for each
// member, and `trial_table`, the store's table of its trials. Inside they work on named values.
//
// Thread rule: pure functions.

#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "elrom/base/members.hpp"
#include "elrom/model/network.hpp"

namespace elrom::networks {

struct Hyperparameters {
  double learning_rate = 1e-3;
  int n_layers = 2;  ///< hidden layers
  int n_units = 64;  ///< in each hidden layer
  int batch_size = 64;
  double weight_decay = 0;  ///< decoupled (AdamW)
  double dropout = 0;
  model::Activation activation = model::Activation::relu;
  bool operator==(const Hyperparameters&) const = default;

  /// In the order of declaration: names in stage files, columns of the trial store (data/FORMATS.md).
  static constexpr std::array names{"learning_rate", "n_layers", "n_units",   "batch_size",
                                    "weight_decay",  "dropout",  "activation"};
  static constexpr const char* trial_table = "trials";
};

/// Calls visit(name, value) for each; of changeable ones to change them.
template <class H, class Visit>
void for_each_hyperparameter(H& hyperparameters, const Visit& visit) {
  using Plain = std::remove_const_t<H>;
  static_assert(Plain::names.size() == base::n_members<Plain>());
  std::size_t i = 0;
  base::for_each_member(hyperparameters, [&](auto& value) { visit(Plain::names[i++], value); });
}

/// Reads back to the same value.
[[nodiscard]] std::string text_of(double value);
[[nodiscard]] std::string text_of(int value);
[[nodiscard]] std::string text_of(model::Activation value);
/// @throws InputError
void read_text(std::string_view text, double& value);
void read_text(std::string_view text, int& value);
void read_text(std::string_view text, model::Activation& value);

/// A hyperparameter of any struct; an enum's value is its text.
struct NamedValue {
  std::string name;
  std::variant<double, int, std::string> value;
};
using NamedValues = std::vector<NamedValue>;

/// Text that is equal for equal values.
[[nodiscard]] std::string key_of(const NamedValues& values);

template <class H>
[[nodiscard]] NamedValues to_values(const H& hyperparameters) {
  NamedValues values;
  for_each_hyperparameter(hyperparameters, [&](const char* name, const auto& value) {
    if constexpr (std::is_enum_v<std::decay_t<decltype(value)>>)
      values.push_back({name, text_of(value)});
    else
      values.push_back({name, value});
  });
  return values;
}

/// @param values as to_values gives them @throws InputError for an unknown name of an enum's value
template <class H>
[[nodiscard]] H from_values(const NamedValues& values) {
  H hyperparameters;
  std::size_t i = 0;
  for_each_hyperparameter(hyperparameters, [&](const char*, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_enum_v<Value>)
      read_text(std::get<std::string>(values.at(i++).value), value);
    else
      value = std::get<Value>(values.at(i++).value);
  });
  return hyperparameters;
}

}  // namespace elrom::networks
