#include "elrom/foam/foam_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace elrom::foam {

std::string header(std::string_view class_name, std::string_view location, std::string_view object,
                   std::string_view note) {
  std::string line(note);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '"' || c == '\n' || c == '\\'; }, ' ');
  return fmt::format(
      "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       {};\n"
      "    note        \"{}\";\n    location    \"{}\";\n    object      {};\n}}\n\n",
      class_name, line, location, object);
}

std::string list(std::span<const float> values) {
  std::string text = fmt::format("{}\n(\n", values.size());
  for (const float value : values) fmt::format_to(std::back_inserter(text), "{}\n", value);
  return text += ")\n";
}

std::string list(std::span<const float> x, std::span<const float> y, std::span<const float> z) {
  std::string text = fmt::format("{}\n(\n", x.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    fmt::format_to(std::back_inserter(text), "({} {} {})\n", x[i], y[i], z[i]);
  return text += ")\n";
}

}  // namespace elrom::foam
