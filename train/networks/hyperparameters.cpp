#include "elrom/networks/hyperparameters.hpp"

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::networks {

std::string text_of(double value) { return base::number(value); }
std::string text_of(int value) { return std::to_string(value); }
std::string text_of(model::Activation value) { return std::string(name_of(value)); }

void read_text(std::string_view text, double& value) {
  const auto number = base::to_double(text);
  if (!number) throw InputError({.what = "no number", .found = std::string(text)});
  value = *number;
}

void read_text(std::string_view text, int& value) {
  double number = 0;
  read_text(text, number);
  value = static_cast<int>(number);
}

void read_text(std::string_view text, model::Activation& value) { value = model::activation_of(text); }

std::string key_of(const NamedValues& values) {
  std::vector<std::string> parts;
  for (const auto& named : values) {
    if (const auto* text = std::get_if<std::string>(&named.value))
      parts.push_back(*text);
    else if (const auto* whole = std::get_if<int>(&named.value))
      parts.push_back(text_of(*whole));
    else
      parts.push_back(text_of(std::get<double>(named.value)));
  }
  return base::join(parts, " ");
}

}  // namespace elrom::networks
