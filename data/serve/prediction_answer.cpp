#include "prediction_answer.hpp"

#include <array>
#include <bit>
#include <charconv>
#include <cstring>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/version.hpp"

namespace elrom::serve {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array axes{"x", "y", "z"};

Json parts_of(const Predicted& predicted) {
  Json all = Json::array();
  const auto& begins = predicted.parts->begins();
  for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
    const bool is_cut = i < predicted.excerpt.cuts.size();
    Json one;
    if (is_cut)
      one = {{"axis", axes[predicted.excerpt.cuts[i].axis]}, {"at", predicted.excerpt.cuts[i].at}};
    else
      one = {{"profile", true}};
    one["places"] = {begins[i], begins[i + 1]};
    all.push_back(std::move(one));
  }
  return all;
}

Json head_of(const Predicted& predicted) {
  const auto& model = predicted.model;
  const auto& assessment = predicted.assessment;
  Json nearest = Json::array();
  for (const auto& one : assessment.nearest)
    nearest.push_back({{"case", one.name}, {"load", one.load}, {"distance", one.distance}});
  Json head{{"case", predicted.inputs.name},
            {"model", {{"name", model.name()}, {"digest", model.bundle().digest()}}},
            {"verdict", model::name_of(assessment.verdict)},
            {"reason", assessment.reason},
            {"out_of_range", assessment.out_of_range},
            {"unusual", assessment.unusual},
            {"distance", assessment.distance},
            {"nearest", nearest},
            {"planes", model.bundle().n_planes()},
            {"columns", model.bundle().n_columns()},
            {"level", predicted.values.half_width.empty() ? Json() : Json(OpenModel::level)}};
  if (predicted.parts != nullptr) head["parts"] = parts_of(predicted);
  return head;
}

std::span<const float> part(const base::LargeArray<float>& all, std::size_t i, std::size_t n) {
  return std::span(all).subspan(i * n, n);
}

/// A header, and what it speaks of behind it.
std::string framed(const Json& head, std::initializer_list<std::span<const std::byte>> blocks) {
  auto header = head.dump();
  header.resize((header.size() + 7) / 8 * 8, ' ');
  const std::uint64_t length = header.size();
  std::size_t size = sizeof length + header.size();
  for (const auto& block : blocks) size += block.size();
  std::string text(size, '\0');
  char* at = text.data();
  const auto put = [&](const void* bytes, std::size_t n) {
    if (n > 0) std::memcpy(at, bytes, n);
    at += n;
  };
  put(&length, sizeof length);
  put(header.data(), header.size());
  for (const auto& block : blocks) put(block.data(), block.size());
  return text;
}

void append_numbers(std::string& text, std::span<const float> values) {
  constexpr std::size_t longest = 16;  // "-1.2345678e-38,"
  const auto begin = text.size();
  text.resize(begin + values.size() * longest + 2);
  char* at = text.data() + begin;
  *at++ = '[';
  for (const float value : values) {
    at = std::to_chars(at, text.data() + text.size(), value).ptr;
    *at++ = ',';
  }
  if (values.empty()) ++at;
  at[-1] = ']';
  text.resize(static_cast<std::size_t>(at - text.data()));
}

}  // namespace

std::string json_answer(const Predicted& predicted) {
  const auto n = predicted.n_values();
  auto text = head_of(predicted).dump();
  text.pop_back();
  text += ",\"fields\":{";
  for (std::size_t i = 0; i < predicted.i_fields.size(); ++i) {
    const auto& info = predicted.model.fields()[predicted.i_fields[i]];
    text +=
        (i > 0 ? "," : "") + Json(info.name).dump() + ":{\"unit\":" + Json(info.unit).dump() + ",\"values\":";
    append_numbers(text, part(predicted.values.values, i, n));
    if (!predicted.values.half_width.empty()) {
      text += ",\"half_width\":";
      append_numbers(text, part(predicted.values.half_width, i, n));
    }
    text += "}";
  }
  return text + "}}\n";
}

std::string binary_answer(const Predicted& predicted) {
  const auto n = predicted.n_values();
  const auto n_values = predicted.values.values.size();
  auto head = head_of(predicted);
  for (std::size_t i = 0; i < predicted.i_fields.size(); ++i) {
    const auto& info = predicted.model.fields()[predicted.i_fields[i]];
    Json one{{"unit", info.unit}, {"values", {i * n, (i + 1) * n}}};
    if (!predicted.values.half_width.empty()) one["half_width"] = {n_values + i * n, n_values + (i + 1) * n};
    head["fields"][info.name] = one;
  }
  return framed(head, {std::as_bytes(std::span(predicted.values.values)),
                       std::as_bytes(std::span(predicted.values.half_width))});
}

std::string polygons_answer(const Cut& cut, const CutPolygons& polygons) {
  const auto cells = polygons.cells.size(), offsets = cells + polygons.offsets.size(),
             points = offsets + polygons.points.size();
  return framed({{"axis", axes[cut.axis]},
                 {"at", cut.at},
                 {"cells", {0, cells}},
                 {"offsets", {cells, offsets}},
                 {"points", {offsets, points}}},
                {std::as_bytes(std::span(polygons.cells)), std::as_bytes(std::span(polygons.offsets)),
                 std::as_bytes(std::span(polygons.points))});
}

std::string cut_answer(const Cut& cut, const model::StoredPrediction& stored,
                       const std::optional<std::vector<std::int32_t>>& cells) {
  Json head{{"axis", axes[cut.axis]}, {"at", cut.at}, {"fields", cells ? Json::object() : Json()}};
  std::vector<float> values;
  for (const auto& field : stored.fields) {
    if (!cells) break;
    head["fields"][field.name] = {{"unit", field.unit},
                                  {"values", {values.size(), values.size() + cells->size()}}};
    for (const auto cell : *cells) values.push_back(field.values[static_cast<std::size_t>(cell)]);
  }
  return framed(head, {std::as_bytes(std::span(values))});
}

std::string hdf_answer(const Predicted& predicted, std::mutex& hdf5, const std::filesystem::path& folder) {
  const auto& bundle = predicted.model.bundle();
  model::PredictionFrame frame{model::Extent(bundle)};
  for (const auto i : predicted.i_fields) frame.fields.push_back(predicted.model.fields()[i]);
  frame.schema = predicted.model.schema();
  if (!predicted.values.half_width.empty()) frame.level = OpenModel::level;
  frame.bundle_digest = bundle.digest();
  frame.mesh_digest = bundle.mesh_digest();
  frame.bundle_program = bundle.file().text("program");
  frame.method = bundle.info().method;
  const model::Prediction prediction{.inputs = &predicted.inputs,
                                     .assessment = &predicted.assessment,
                                     .values = predicted.values.values,
                                     .half_width = predicted.values.half_width};
  std::filesystem::create_directories(folder);
  const base::AtomicFile file(folder / "prediction.hdf", base::Sync::none);  // read at once, and gone
  const std::scoped_lock lock(hdf5);
  model::PredictionWriter(frame, predicted.inputs, predicted.assessment, file.temporary()).finish(prediction);
  return base::read_text(file.temporary());
}

}  // namespace elrom::serve
