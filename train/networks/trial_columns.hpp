#pragma once
// The hyperparameters' columns of the trial store, from their one list. Internal to trial_store.cpp.

#include <string>
#include <type_traits>
#include <vector>

#include "elrom/networks/hyperparameters.hpp"

namespace elrom::networks {

/// Type of a hyperparameter's column.
template <class T>
constexpr const char* column_type() {
  return std::is_enum_v<T> ? "TEXT" : std::is_integral_v<T> ? "INTEGER" : "REAL";
}

/// "learning_rate REAL, n_layers INTEGER, ..."
[[nodiscard]] inline std::vector<std::string> column_declarations() {
  std::vector<std::string> columns;
  const Hyperparameters defaults;
  for_each_hyperparameter(defaults, [&](const char* name, const auto& value) {
    columns.push_back(std::string(name) + " " + column_type<std::decay_t<decltype(value)>>());
  });
  return columns;
}

/// What a column that an older file lacks stands for: "dropout REAL DEFAULT '0'".
[[nodiscard]] inline std::string declaration_with_default(std::string_view wanted) {
  std::string declaration;
  const Hyperparameters defaults;
  for_each_hyperparameter(defaults, [&](std::string_view name, const auto& value) {
    if (name != wanted) return;
    declaration = std::string(name) + " " + column_type<std::decay_t<decltype(value)>>() + " DEFAULT '" +
                  text_of(value) + "'";
  });
  return declaration;
}

/// @param first number of the first parameter @return that of the one behind the last
template <class Statement>
int bind_hyperparameters(Statement& statement, int first, const Hyperparameters& hyperparameters) {
  for_each_hyperparameter(hyperparameters, [&](const char*, const auto& value) {
    if constexpr (std::is_enum_v<std::decay_t<decltype(value)>>)
      statement.bind(first++, text_of(value));
    else
      statement.bind(first++, value);
  });
  return first;
}

/// @param first number of the first column @return that of the one behind the last
template <class Statement>
int read_hyperparameters(const Statement& row, int first, Hyperparameters& hyperparameters) {
  for_each_hyperparameter(hyperparameters, [&](const char*, auto& value) {
    using Value = std::decay_t<decltype(value)>;
    if constexpr (std::is_enum_v<Value>)
      read_text(row.text(first++), value);
    else
      value = static_cast<Value>(row.real(first++));
  });
  return first;
}

}  // namespace elrom::networks
