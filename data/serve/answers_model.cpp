#include <algorithm>
#include <cmath>
#include <cstring>

#include "desk.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/user_unit.hpp"
#include "elrom/repository/rules.hpp"
#include "prediction_answer.hpp"
#include "problem.hpp"

namespace elrom::serve {
namespace {

using repository::Role;

/// Where an input enters the furnace, as far as its description tells.
Json opening_of(const std::optional<field::Furnace>& furnace, const std::string& input) {
  if (!furnace) return nullptr;
  const auto found = std::ranges::find_if(
      furnace->openings, [&](const field::Opening& opening) { return base::matches(input, opening.inputs); });
  if (found == furnace->openings.end()) return nullptr;
  return {{"kind", found->kind}, {"low_m", found->low_m}, {"high_m", found->high_m}};
}

Json inputs_of(const OpenModel& model) {
  const auto furnace = model.bundle().furnace();
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
                   {"display_high", unit.from_si(high)},
                   {"opening", opening_of(furnace, info.name)}});
  }
  return all;
}

Json fields_of(const OpenModel& model) {
  Json all = Json::array();
  for (const auto& info : model.fields())
    all.push_back({{"name", info.name}, {"meaning", info.meaning}, {"unit", info.unit}});
  return all;
}

Json extent_of(const Cuts& cuts) {
  return {{"low", cuts.low()}, {"high", cuts.high()}, {"heights", cuts.heights()}};
}

http::Response about_model(Desk& desk, const Ask& ask) {
  const auto model = open_model(desk);
  const auto furnace = model->bundle().furnace();
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
                          {"furnace", furnace ? Json(furnace->name) : Json()},
                          {"extent", extent_of(model->cuts())},
                          {"level", model->has_intervals() ? Json(OpenModel::level) : Json()},
                          {"inputs", inputs_of(*model)},
                          {"fields", fields_of(*model)},
                          {"files", file_formats(desk)},
                          {"provenance", bundle.info().provenance},
                          {"accuracy", Json::parse(bundle.info().accuracy_json)}},
                         "\"" + bundle.digest() + "\"");
}

http::Response cases(Desk& desk, const Ask& ask) {
  const auto model = open_model(desk);
  const auto& guard = model->guard();
  Json names = Json::array(), items = Json::array();
  for (const auto& info : model->schema().inputs()) names.push_back(info.name + " [" + info.unit + "]");
  for (std::size_t i = 0; i < guard.names().size(); ++i) {
    const auto row = guard.inputs().row(static_cast<Eigen::Index>(i));
    items.push_back({{"name", guard.names()[i]},
                     {"load", std::isfinite(guard.loads()[i]) ? Json(guard.loads()[i]) : Json()},
                     {"values", std::vector<double>(row.begin(), row.end())}});
  }
  return tagged_response(ask, {{"inputs", names}, {"items", items}}, "\"" + model->bundle().digest() + "\"");
}

/// @throws Fault for what is no axis, no number or nowhere in the mesh
template <class Fault>
Cut cut_of(const Cuts& cuts, const std::string& axis, double at, const std::string& where) {
  constexpr std::string_view axes = "xyz";
  const auto i_axis = axis.size() == 1 ? axes.find(axis[0]) : std::string_view::npos;
  if (i_axis == std::string_view::npos)
    throw Fault(
        Problem{.what = "no axis", .where = where, .found = "'" + axis + "'", .expected = "x, y or z"});
  const Cut cut{.axis = i_axis, .at = at};
  if (cuts.meets(cut)) return cut;
  throw Fault(Problem{
      .what = "the cut misses the furnace",
      .where = where,
      .found = axis + " = " + base::rounded(at) + " m",
      .expected = base::rounded(cuts.low()[i_axis]) + " to " + base::rounded(cuts.high()[i_axis]) + " m"});
}

http::Response cut_mesh(Desk& desk, const Ask& ask) {
  const auto model = open_model(desk);
  const auto wanted = cut_in_query(ask, model->cuts());
  const auto tag = "\"" + model->bundle().mesh_digest() + "\"";
  if (auto known = known_already(ask.request, tag)) return std::move(*known);
  return {.headers = {{"Content-Type", "application/octet-stream"}, {"ETag", tag}},
          .body = polygons_answer(wanted, model->cuts().polygons(wanted))};
}

http::Response mesh(Desk& desk, const Ask& ask) {
  const auto model = open_model(desk);
  const auto tag = "\"" + model->bundle().mesh_digest() + "\"";
  if (auto known = known_already(ask.request, tag)) return std::move(*known);
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

/// "cuts" and "profile" of a request; with neither, all cells are meant.
Excerpt excerpt_in(const JsonBody& body, const OpenModel& model) {
  constexpr std::size_t most = 32;
  Excerpt excerpt{.cuts = {}, .profile = body.flag_or("profile", false)};
  if (!body.has("cuts")) return excerpt;
  const auto& wanted = body.at("cuts");
  if (!wanted.is_array() || wanted.size() > most)
    throw InputError(Problem{.what = "wrong cuts", .where = "request", .expected = "a list of at most 32"});
  for (const auto& one : wanted) {
    const JsonBody cut(one.dump(), {"axis", "at"}, "cuts");
    excerpt.cuts.push_back(cut_of<InputError>(model.cuts(), cut.text("axis"), cut.number("at"), "cuts"));
  }
  return excerpt;
}

http::Response answer_in(Form form, const Predicted& predicted, Desk& desk) {
  http::Response response{.headers = {{"Cache-Control", "no-store"}}};
  switch (form) {
    case Form::json:
      response.body = json_answer(predicted);
      break;
    case Form::binary:
      response.body = binary_answer(predicted);
      break;
    case Form::hdf:
      if (predicted.parts != nullptr)
        throw InputError(Problem{.what = "a file of fields holds all cells",
                                 .expected = "no cuts and no profile, or another form of the answer"});
      response.body = hdf_answer(predicted, desk.hdf5, desk.options.repository.folder / "outgoing");
      break;
  }
  return response;
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
  const JsonBody body(ask.request.body, {"case", "load", "inputs", "fields", "intervals", "cuts", "profile"});
  const auto judged = judge_case(body, *model);
  const auto i_fields = chosen_fields(*model, body.texts("fields"));
  const auto excerpt = excerpt_in(body, *model);
  auto values = model->predict(judged.inputs.values, i_fields, body.flag_or("intervals", true),
                               base::available_threads());
  std::optional<ExcerptParts> parts;
  if (!excerpt.everything()) {
    parts.emplace(model->cuts(), excerpt);
    values.values = parts->of(values.values, model->n_cells());
    values.half_width = parts->of(values.half_width, model->n_cells());
  }
  auto response = answer_in(
      media->form,
      {*model, judged.inputs, *judged.assessment, i_fields, values, excerpt, parts ? &*parts : nullptr},
      desk);
  response.headers.emplace_back("Content-Type", media->type);
  return response;
}

}  // namespace

Cut cut_in_query(const Ask& ask, const Cuts& cuts) {
  const auto text = ask.target.value("at").value_or("");
  const auto at = base::to_double(text);
  if (!at || !std::isfinite(*at))
    throw UsageError(
        Problem{.what = "wrong at", .where = "query", .found = "'" + text + "'", .expected = "a place [m]"});
  return cut_of<UsageError>(cuts, ask.target.value("axis").value_or(""), *at, "query");
}

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
      {.method = "GET",
       .path = "/model/cases",
       .role = Role::reader,
       .summary = "The cases that it was trained on: loads and inputs, SI",
       .answers = {{200, "all of them"}, {404, "there is no model yet"}},
       .answer = cases,
       .tagged = true},
      {.method = "GET",
       .path = "/mesh/cut",
       .role = Role::reader,
       .summary = "The polygons of the cells that a plane cut goes through",
       .answers =
           {{200,
             "a JSON header and the numbers, as POST /predictions answers with application/octet-stream"},
            {400, "no such cut"},
            {404, "there is no model yet"}},
       .answer = cut_mesh,
       .query = {{"axis", "x, y or z"}, {"at", "where on it [m]"}},
       .media = {"application/octet-stream"},
       .tagged = true},
      {.method = "POST",
       .path = "/predictions",
       .role = Role::reader,
       .summary =
           "Fields of an operating point, with intervals and what the guard says; of all cells, or of `cuts` and "
           "plane averages (`profile`); nothing is kept of it",
       .answers = {{200, "the fields"}, {404, "there is no model yet"}, {406, "no such form of an answer"}},
       .answer = predict,
       .body = BodyKind::json,
       .example =
           R"({"case": "a", "load": 1.0, "inputs": {}, "fields": ["pressure"], "intervals": true, "cuts": [{"axis": "z", "at": 1.0}], "profile": true})",
       .wrong = R"({"inputs": {"nothing of a furnace": 1}})",
       .required = {"inputs"},
       .media = {"application/json", "application/octet-stream", "application/x-hdf5"}}};
}

}  // namespace elrom::serve
