#include <algorithm>
#include <cstring>

#include "desk.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/field/user_unit.hpp"
#include "elrom/repository/rules.hpp"
#include "prediction_answer.hpp"
#include "problem.hpp"

namespace elrom::serve {
namespace {

using repository::Role;

std::shared_ptr<const OpenModel> open_model(Desk& desk) {
  auto model = desk.model.now();
  if (model) return model;
  throw repository::NotFoundError(Problem{.what = "no model yet",
                                          .where = desk.options.model.string(),
                                          .advice = "train one with elrom-train run"});
}

Json inputs_of(const OpenModel& model) {
  Json all = Json::array();
  for (std::size_t i = 0; i < model.schema().size(); ++i) {
    const auto& info = model.schema()[i];
    const auto& unit = field::user_unit(info);
    const double low = model.guard().low()[i], high = model.guard().high()[i];
    all.push_back({{"name", info.name},
                   {"unit", info.unit},
                   {"low", low},
                   {"high", high},
                   {"display_unit", unit.symbol},
                   {"display_low", unit.from_si(low)},
                   {"display_high", unit.from_si(high)}});
  }
  return all;
}

Json fields_of(const OpenModel& model) {
  Json all = Json::array();
  for (const auto& info : model.fields())
    all.push_back({{"name", info.name}, {"meaning", info.meaning}, {"unit", info.unit}});
  return all;
}

http::Response about_model(Desk& desk, const Ask& ask) {
  const auto model = open_model(desk);
  const auto& bundle = model->bundle();
  return tagged_response(ask,
                         {{"name", model->name()},
                          {"digest", bundle.digest()},
                          {"program", bundle.file().text("program")},
                          {"method", bundle.info().method},
                          {"cases", bundle.info().cases.size()},
                          {"planes", bundle.n_planes()},
                          {"columns", bundle.n_columns()},
                          {"mesh_digest", bundle.mesh_digest()},
                          {"level", model->has_intervals() ? Json(OpenModel::level) : Json()},
                          {"inputs", inputs_of(*model)},
                          {"fields", fields_of(*model)},
                          {"provenance", bundle.info().provenance},
                          {"accuracy", Json::parse(bundle.info().accuracy_json)}},
                         "\"" + bundle.digest() + "\"");
}

http::Response mesh(Desk& desk, const Ask& ask) {
  const auto model = open_model(desk);
  const auto tag = "\"" + model->bundle().mesh_digest() + "\"";
  const auto* has = ask.request.header("If-None-Match");
  if (has != nullptr && *has == tag) return {.status = 304, .headers = {{"ETag", tag}}};
  const auto mesh = model->bundle().mesh({.with_corners = false});
  http::Response response{.headers = {{"Content-Type", "application/octet-stream"}, {"ETag", tag}}};
  response.body.resize(static_cast<std::size_t>(mesh.centre.size()) * sizeof(float));
  for (Eigen::Index i = 0; i < mesh.centre.size(); ++i) {
    const auto value = static_cast<float>(mesh.centre.data()[i]);
    std::memcpy(response.body.data() + static_cast<std::size_t>(i) * sizeof value, &value, sizeof value);
  }
  return response;
}

std::vector<std::size_t> chosen_fields(const OpenModel& model, const std::vector<std::string>& names) {
  std::vector<std::size_t> chosen;
  for (const auto& info : field::choose_fields<InputError>(model.fields(), names, "request"))
    chosen.push_back(static_cast<std::size_t>(
        std::ranges::find(model.fields(), info.name, &field::FieldInfo::name) - model.fields().begin()));
  return chosen;
}

enum class Form { json, binary, hdf };
struct Media {
  Form form;
  const char* type;
};
constexpr Media medias[] = {{Form::json, "application/json"},
                            {Form::binary, "application/octet-stream"},
                            {Form::hdf, "application/x-hdf5"}};

/// The first of ours that the caller names; nullptr: none. Weights are not looked at.
const Media* accepted(const Ask& ask) {
  const auto* wish = ask.request.header("Accept");
  if (wish == nullptr || wish->find("*/*") != std::string::npos) return &medias[0];
  for (const auto& media : medias)
    if (wish->find(media.type) != std::string::npos) return &media;
  return nullptr;
}

http::Response predict(Desk& desk, const Ask& ask) {
  const auto model = open_model(desk);  // held to the end, whatever `current` does meanwhile
  const auto* media = accepted(ask);
  if (media == nullptr)
    return problem_response(406,
                            {.what = "no such form of an answer",
                             .where = "Accept",
                             .found = *ask.request.header("Accept"),
                             .expected = "application/json, application/octet-stream or application/x-hdf5"});
  const JsonBody body(ask.request.body, {"case", "load", "inputs", "fields", "intervals"});
  Json one{{"case", body.text_or("case", "case")}, {"inputs", body.at("inputs")}};
  if (body.has("load")) one["load"] = body.number("load");
  const auto judged = repository::judge_inputs(one.dump(), "request", &model->schema(), &model->guard());
  const auto i_fields = chosen_fields(*model, body.texts("fields"));
  const auto values = model->predict(judged.inputs.values, i_fields, body.flag_or("intervals", true),
                                     base::available_threads());
  const Predicted predicted{*model, judged.inputs, *judged.assessment, i_fields, values};
  http::Response response{.headers = {{"Content-Type", media->type}, {"Cache-Control", "no-store"}}};
  switch (media->form) {
    case Form::json:
      response.body = json_answer(predicted);
      break;
    case Form::binary:
      response.body = binary_answer(predicted);
      break;
    case Form::hdf:
      response.body = hdf_answer(predicted, desk.hdf5, desk.options.repository.folder / "outgoing");
      break;
  }
  return response;
}

}  // namespace

std::vector<Route> model_routes() {
  return {
      {.method = "GET",
       .path = "/model",
       .role = Role::reader,
       .summary =
           "The model that answers: its inputs with their trained ranges, its fields, how it came about",
       .answers = {{200, "it"}, {404, "there is none yet"}},
       .answer = about_model,
       .tagged = true},
      {.method = "GET",
       .path = "/mesh",
       .role = Role::reader,
       .summary = "Centres of its cells: float32, little-endian, (planes, columns, 3), m",
       .answers = {{200, "the numbers"}, {404, "there is no model yet"}},
       .answer = mesh,
       .media = {"application/octet-stream"},
       .tagged = true},
      {.method = "POST",
       .path = "/predictions",
       .role = Role::reader,
       .summary =
           "Fields of an operating point, with intervals and what the guard says; nothing is kept of it",
       .answers = {{200, "the fields"}, {404, "there is no model yet"}, {406, "no such form of an answer"}},
       .answer = predict,
       .body = BodyKind::json,
       .example = R"({"case": "a", "load": 1.0, "inputs": {}, "fields": ["pressure"], "intervals": true})",
       .wrong = R"({"inputs": {"nothing of a furnace": 1}})",
       .required = {"inputs"},
       .media = {"application/json", "application/octet-stream", "application/x-hdf5"}}};
}

}  // namespace elrom::serve
