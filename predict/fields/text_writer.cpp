#include "elrom/fields/text_writer.hpp"

#include <array>
#include <charconv>
#include <map>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"

namespace elrom::fields {
namespace {

/// Shortest text that reads back to the same float.
void add_shortest(std::string& text, float value) {
  std::array<char, 32> buffer;
  text.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

void add_whole(std::string& text, std::int32_t value) {
  std::array<char, 16> buffer;
  text.append(buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr);
}

/// Scientific with `digits` behind the point, right-aligned in `width`.
void add_scientific(std::string& text, float value, int digits, std::size_t width) {
  std::array<char, 48> buffer;
  const auto* end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                  std::chars_format::scientific, digits)
                        .ptr;
  const auto length = static_cast<std::size_t>(end - buffer.data());
  if (length < width) text.append(width - length, ' ');
  text.append(buffer.data(), length);
}

/// A column of a table: its heading and the values of all rows, `stride` apart.
struct Column {
  std::string name, unit;
  const float* values;
  std::size_t stride;
};

std::vector<Column> columns_of(const model::PredictionFrame& frame, const Coordinates& coordinates,
                               const model::Prediction& prediction) {
  std::vector<Column> columns;
  const std::size_t n_axes = coordinates.axes.size();
  const std::size_t n_values = coordinates.values.size() / n_axes;
  check(prediction.values.size() == n_values * frame.fields.size(),
        "text export: coordinates of every value");
  const auto of_field = [&](std::span<const float> all, std::size_t i) { return all.data() + i * n_values; };
  for (std::size_t axis = 0; axis < n_axes; ++axis)
    columns.push_back({coordinates.axes[axis], "m", coordinates.values.data() + axis, n_axes});
  for (std::size_t i = 0; i < frame.fields.size(); ++i) {
    columns.push_back({frame.fields[i].name, frame.fields[i].unit, of_field(prediction.values, i), 1});
  }
  for (std::size_t i = 0; frame.level && i < frame.fields.size(); ++i) {
    columns.push_back(
        {frame.fields[i].name + "_half_width", frame.fields[i].unit, of_field(prediction.half_width, i), 1});
  }
  return columns;
}

/// Fluent's own names where it has them; solids are named alike (--names gives the phase names of a case).
std::string fluent_name(const std::string& name, const std::map<std::string, std::string>& chosen) {
  static const std::map<std::string, std::string> names{
      {"gas_velocity_x", "x-velocity"},          {"gas_velocity_y", "y-velocity"},
      {"gas_velocity_z", "z-velocity"},          {"solid_velocity_x", "solids-x-velocity"},
      {"solid_velocity_y", "solids-y-velocity"}, {"solid_velocity_z", "solids-z-velocity"},
      {"solid_volume_fraction", "solids-vof"},   {"solid_diameter", "solids-diameter"}};
  if (const auto found = chosen.find(name); found != chosen.end()) return found->second;
  const auto known = names.find(name);
  return known != names.end() ? known->second : name;
}

void add_comment(const model::PredictionFrame& frame, const model::Prediction& prediction,
                 std::string& text) {
  text += "# ELROM prediction for SFW3D, format 1.0\n# program " + program_version() + ", bundle " +
          frame.bundle_digest + "\n";
  text += "# case " + prediction.inputs->name + "\n# validity " +
          std::string(model::name_of(prediction.assessment->verdict)) + ": " + prediction.assessment->reason +
          "\n";
  if (frame.level)
    text += "# half-widths of prediction intervals of level " + base::number(*frame.level) + "\n";
  if (prediction.change == nullptr) return;
  for (const auto& line : base::split(model::to_text(*prediction.change), '\n'))
    if (!line.empty()) text += "# conserved: " + line + "\n";
}

}  // namespace

void expect_fluent_names_differ(const std::vector<field::FieldInfo>& fields,
                                const std::map<std::string, std::string>& chosen) {
  std::map<std::string, std::string> taken;  // field by name
  for (const auto& info : fields) {
    const auto [other, is_new] = taken.emplace(fluent_name(info.name, chosen), info.name);
    if (!is_new)
      throw UsageError({.what = "--names gives two fields one name",
                        .found = "'" + other->first + "' for " + other->second + " and " + info.name,
                        .advice = "give one of them another name"});
  }
}

Coordinates coordinates_of(const model::PlaneAverage& average) { return {{"z"}, average.heights()}; }
Coordinates coordinates_of(const model::CellGeometry& geometry) { return {{"x", "y", "z"}, geometry.centre}; }
Coordinates coordinates_of(const field::Mesh& mesh) {
  return {{"x", "y", "z"}, {mesh.centre.data(), mesh.centre.data() + mesh.centre.size()}};
}

void write_csv(const model::PredictionFrame& frame, const Coordinates& coordinates,
               const model::Prediction& prediction, std::string& text) {
  const auto columns = columns_of(frame, coordinates, prediction);
  text += frame.extent.average() ? "plane" : "plane,column";
  for (const auto& column : columns) text += "," + column.name + " [" + column.unit + "]";
  text += '\n';
  const auto& cells = frame.extent.cells();
  for (std::size_t row = 0; row < frame.n_values(); ++row) {
    if (frame.extent.average()) {
      add_whole(text, cells.planes()[row]);
    } else {
      add_whole(text, cells.plane(row));
      text += ',';
      add_whole(text, cells.column(row));
    }
    for (const auto& column : columns) {
      text += ',';
      add_shortest(text, column.values[row * column.stride]);
    }
    text += '\n';
  }
}

void write_sfw3d(const model::PredictionFrame& frame, const Coordinates& coordinates,
                 const model::Prediction& prediction, std::string& text) {
  constexpr int digits = 7;
  constexpr std::size_t width = 16;
  const auto columns = columns_of(frame, coordinates, prediction);
  add_comment(frame, prediction, text);
  text += "# " + std::to_string(frame.n_values()) + (frame.extent.average() ? " planes" : " cells") +
          "; columns:";
  for (const auto& column : columns) text += " " + column.name + "[" + column.unit + "]";
  text += '\n';
  for (std::size_t row = 0; row < frame.n_values(); ++row) {
    for (const auto& column : columns)
      add_scientific(text, column.values[row * column.stride], digits, width);
    text += '\n';
  }
}

void write_fluent(const model::PredictionFrame& frame, const Coordinates& coordinates,
                  const model::Prediction& prediction, std::string& text) {
  constexpr int digits = 9;
  constexpr std::size_t n_coordinates = 3;
  const auto columns = columns_of(frame, coordinates, prediction);
  const std::size_t n_values = coordinates.values.size() / n_coordinates;
  text += "3\n3\n" + std::to_string(n_values) + "\n" + std::to_string(columns.size() - n_coordinates) + "\n";
  for (std::size_t i = n_coordinates; i < columns.size(); ++i)
    text += fluent_name(columns[i].name, coordinates.names) + "\n";
  for (const auto& column : columns) {
    text += '(';
    for (std::size_t row = 0; row < n_values; ++row) {
      add_scientific(text, column.values[row * column.stride], digits, 0);
      text += '\n';
    }
    text += ")\n";
  }
}

}  // namespace elrom::fields
