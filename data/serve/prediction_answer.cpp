#include "prediction_answer.hpp"

#include <bit>
#include <charconv>
#include <cstring>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/version.hpp"
#include "elrom/model/prediction_file.hpp"

namespace elrom::serve {
namespace {

static_assert(std::endian::native == std::endian::little);

Json head_of(const Predicted& predicted) {
  const auto& [model, inputs, assessment, i_fields, values] = predicted;
  Json nearest = Json::array();
  for (const auto& one : assessment.nearest)
    nearest.push_back({{"case", one.name}, {"load", one.load}, {"distance", one.distance}});
  return {{"case", inputs.name},
          {"model", {{"name", model.name()}, {"digest", model.bundle().digest()}}},
          {"verdict", model::name_of(assessment.verdict)},
          {"reason", assessment.reason},
          {"out_of_range", assessment.out_of_range},
          {"unusual", assessment.unusual},
          {"distance", assessment.distance},
          {"nearest", nearest},
          {"planes", model.bundle().n_planes()},
          {"columns", model.bundle().n_columns()},
          {"level", values.half_width.empty() ? Json() : Json(OpenModel::level)}};
}

std::span<const float> part(const base::LargeArray<float>& all, std::size_t i, std::size_t n) {
  return std::span(all).subspan(i * n, n);
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
  const auto n = predicted.model.n_cells();
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
  const auto n = predicted.model.n_cells();
  const auto n_values = predicted.values.values.size();
  auto head = head_of(predicted);
  for (std::size_t i = 0; i < predicted.i_fields.size(); ++i) {
    const auto& info = predicted.model.fields()[predicted.i_fields[i]];
    Json one{{"unit", info.unit}, {"values", {i * n, (i + 1) * n}}};
    if (!predicted.values.half_width.empty()) one["half_width"] = {n_values + i * n, n_values + (i + 1) * n};
    head["fields"][info.name] = one;
  }
  auto header = head.dump();
  header.resize((header.size() + 7) / 8 * 8, ' ');
  const std::uint64_t length = header.size();
  const auto bytes_of = [](const base::LargeArray<float>& values) { return values.size() * sizeof(float); };
  std::string text(
      sizeof length + length + bytes_of(predicted.values.values) + bytes_of(predicted.values.half_width),
      '\0');
  char* at = text.data();
  const auto put = [&](const void* bytes, std::size_t size) {
    if (size > 0) std::memcpy(at, bytes, size);
    at += size;
  };
  put(&length, sizeof length);
  put(header.data(), header.size());
  put(predicted.values.values.data(), bytes_of(predicted.values.values));
  put(predicted.values.half_width.data(), bytes_of(predicted.values.half_width));
  return text;
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
