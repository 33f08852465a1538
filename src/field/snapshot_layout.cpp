#include "snapshot_layout.hpp"

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/units.hpp"

namespace elrom::field::detail {

namespace {

/// Of units that not every ELROM knows: what they are in SI.
void write_scales(const io::Hdf5Group& group, const InputSchema& schema) {
  std::vector<double> factors, offsets;
  bool all_common = true;
  for (const auto& input : schema.inputs()) {
    const auto& unit = base::unit(input.display_unit);
    factors.push_back(unit.factor);
    offsets.push_back(unit.offset);
    all_common = all_common && base::is_common_unit(unit.symbol);
  }
  if (all_common) return;
  group.write<double>("factor", factors);
  group.write<double>("offset", offsets);
}

void read_scales(const io::Hdf5Group& group, const std::vector<InputInfo>& inputs) {
  if (!group.has("factor")) return;
  const auto numbers = [&](const char* name) {
    group.dataset(name).expect_shape({inputs.size()});
    return group.dataset(name).read<double>();
  };
  const auto factors = numbers("factor"), offsets = numbers("offset");
  for (std::size_t i = 0; i < inputs.size(); ++i)
    base::know_unit({inputs[i].display_unit, inputs[i].unit, factors[i], offsets[i]});
}

}  // namespace

void write_schema(const io::Hdf5Group& root, const InputSchema& schema) {
  std::vector<std::string> units, display;
  for (const auto& input : schema.inputs()) {
    units.push_back(input.unit);
    display.push_back(input.display_unit);
  }
  const auto group = root.create_group("inputs");
  group.write_texts("name", schema.names());
  group.write_texts("unit", units);
  group.write_texts("display_unit", display);
  write_scales(group, schema);
}

InputSchema read_schema(const io::Hdf5Group& root) {
  const auto group = root.group("inputs");
  const auto names = group.dataset("name").read_texts();
  group.dataset("unit").expect_shape({names.size()});
  group.dataset("display_unit").expect_shape({names.size()});
  const auto units = group.dataset("unit").read_texts(), display = group.dataset("display_unit").read_texts();
  std::vector<InputInfo> inputs;
  for (std::size_t i = 0; i < names.size(); ++i) inputs.push_back({names[i], units[i], display[i]});
  read_scales(group, inputs);
  return InputSchema(std::move(inputs));
}

void write_cases(const io::Hdf5Group& root, const std::vector<CaseRecord>& cases, std::size_t n_inputs,
                 std::size_t n_fields) {
  std::vector<std::string> names, sources, source_digests, content_digests;
  std::vector<double> loads, windows, inputs, errors;
  for (const auto& one : cases) {
    names.push_back(one.inputs.name);
    sources.push_back(one.source);
    source_digests.push_back(one.source_digest);
    content_digests.push_back(one.content_digest);
    loads.push_back(one.inputs.load);
    windows.push_back(one.averaging_window_s);
    inputs.insert(inputs.end(), one.inputs.values.begin(), one.inputs.values.end());
    const auto unknown = std::vector(n_fields, std::nan(""));
    const auto& error = one.resampling_error.empty() ? unknown : one.resampling_error;
    errors.insert(errors.end(), error.begin(), error.end());
  }
  if (root.has("cases")) root.remove("cases");
  const auto group = root.create_group("cases");
  group.write_texts("name", names);
  group.write_texts("source", sources);
  group.write_texts("source_digest", source_digests);
  group.write_texts("content_digest", content_digests);
  group.write<double>("load", loads);
  group.write<double>("averaging_window_s", windows);
  group.write<double>("inputs", inputs, {cases.size(), n_inputs});
  group.write<double>("resampling_error", errors, {cases.size(), n_fields});
}

std::vector<CaseRecord> read_cases(const io::Hdf5Group& root, std::size_t n_inputs, std::size_t n_fields) {
  const auto group = root.group("cases");
  const auto names = group.dataset("name").read_texts();
  const auto n = names.size();
  const auto texts = [&](const char* name) {
    group.dataset(name).expect_shape({n});
    return group.dataset(name).read_texts();
  };
  const auto numbers = [&](const char* name, const io::Shape& shape) {
    group.dataset(name).expect_shape(shape);
    return group.dataset(name).read<double>();
  };
  const auto sources = texts("source"), source_digests = texts("source_digest"),
             content_digests = texts("content_digest");
  const auto loads = numbers("load", {n}), windows = numbers("averaging_window_s", {n});
  const auto inputs = numbers("inputs", {n, n_inputs}), errors = numbers("resampling_error", {n, n_fields});
  const auto row = [](const std::vector<double>& table, std::size_t i, std::size_t width) {
    const auto begin = table.begin() + static_cast<std::ptrdiff_t>(i * width);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(width));
  };
  std::vector<CaseRecord> cases(n);
  for (std::size_t i = 0; i < n; ++i) {
    cases[i] = {.inputs = {.name = names[i], .load = loads[i], .values = row(inputs, i, n_inputs)},
                .source = sources[i],
                .source_digest = source_digests[i],
                .averaging_window_s = windows[i],
                .resampling_error = row(errors, i, n_fields),
                .content_digest = content_digests[i]};
    auto& error = cases[i].resampling_error;
    if (!error.empty() && std::isnan(error.front())) error.clear();
  }
  return cases;
}

void write_furnace(const io::Hdf5Group& root, const Furnace& furnace) {
  if (root.has("furnace")) root.remove("furnace");
  root.write_texts("furnace", {to_toml(furnace)});
}

std::optional<Furnace> read_furnace(const io::Hdf5Group& root) {
  if (!root.has("furnace")) return std::nullopt;
  const auto dataset = root.dataset("furnace");
  dataset.expect_shape({1});
  return parse_furnace(dataset.read_texts().front(), dataset.where());
}

void create_fields(const io::Hdf5Group& root, const std::vector<FieldInfo>& fields, const Mesh& mesh) {
  const auto group = root.create_group("fields");
  // Level 1: the last digits of averaged fields are noise, which no level shrinks.
  const io::Hdf5Storage storage{.chunk = {1, mesh.n_planes, mesh.n_columns},
                                .deflate = 1,
                                .shuffle = true,
                                .fletcher32 = true,
                                .extendable = true};
  std::vector<std::string> names;
  for (const auto& field : fields) {
    const auto dataset = group.create<float>(field.name, {0, mesh.n_planes, mesh.n_columns}, storage);
    dataset.set_text("unit", field.unit);
    dataset.set_text("meaning", field.meaning);
    names.push_back(field.name);
  }
  root.write_texts("field_names", names);
}

std::vector<FieldInfo> read_fields(const io::Hdf5Group& root) {
  const auto group = root.group("fields");
  std::vector<FieldInfo> fields;
  for (const auto& name : root.dataset("field_names").read_texts()) {
    const auto dataset = group.dataset(name);
    auto field = field_info(name, dataset.text("unit"));
    if (field.unit != dataset.text("unit")) {
      throw InputError({.what = "wrong unit",
                        .where = dataset.where(),
                        .found = dataset.text("unit"),
                        .expected = field.unit});
    }
    field.meaning = dataset.text("meaning");
    fields.push_back(std::move(field));
  }
  return fields;
}

}  // namespace elrom::field::detail
