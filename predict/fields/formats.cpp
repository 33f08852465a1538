#include "elrom/fields/formats.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::fields {
namespace {

constexpr std::array<FormatInfo, 5> table{{{Format::hdf, "hdf", nullptr, true},
                                           {Format::csv, "csv", write_csv, true},
                                           {Format::txt, "txt", write_sfw3d, true},
                                           {Format::ip, "ip", write_fluent, false},
                                           {Format::openfoam, "openfoam", nullptr, false}}};

}  // namespace

std::span<const FormatInfo> formats() { return table; }

const FormatInfo& info_of(Format format) { return *std::ranges::find(table, format, &FormatInfo::format); }

const FormatInfo& format_named(std::string_view name) {
  const auto found =
      std::ranges::find(table, name, [](const auto& row) { return std::string_view(row.name); });
  if (found != table.end()) return *found;
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  throw UsageError({.what = "no format '" + std::string(name) + "'",
                    .expected = base::join(names, ", "),
                    .advice = base::name_advice(std::string(name), names)});
}

}  // namespace elrom::fields
