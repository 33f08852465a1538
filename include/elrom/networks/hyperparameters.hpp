#pragma once
// What the search looks for, and the one list of it. Stage files, the search space, the trial store,
// checkpoints and messages between processes go through the list: a new hyperparameter is a member, its name,
// and the values that it is searched over (search_space.cpp).
//
// Thread rule: pure functions.

#include <array>
#include <string>
#include <string_view>

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
};

/// In the order of declaration: names in stage files, columns of the trial store (data/FORMATS.md).
inline constexpr std::array hyperparameter_names{"learning_rate", "n_layers", "n_units",   "batch_size",
                                                 "weight_decay",  "dropout",  "activation"};
static_assert(hyperparameter_names.size() == base::n_members<Hyperparameters>());

/// Calls visit(name, value) for each; of changeable ones to change them.
template <class H, class Visit>
void for_each_hyperparameter(H& hyperparameters, const Visit& visit) {
  std::size_t i = 0;
  base::for_each_member(hyperparameters, [&](auto& value) { visit(hyperparameter_names[i++], value); });
}

/// Reads back to the same value.
[[nodiscard]] std::string text_of(double value);
[[nodiscard]] std::string text_of(int value);
[[nodiscard]] std::string text_of(model::Activation value);
/// @throws InputError
void read_text(std::string_view text, double& value);
void read_text(std::string_view text, int& value);
void read_text(std::string_view text, model::Activation& value);

}  // namespace elrom::networks
