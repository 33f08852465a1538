#include "desk.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/text.hpp"
#include "elrom/repository/secret.hpp"
#include "elrom/study/versions.hpp"

namespace elrom::serve {
namespace {

using repository::NotFoundError;
using repository::Role;

/// @throws NotFoundError when it is no study's model that answers
study::Versions versions_of(const Desk& desk) {
  if (std::filesystem::is_directory(desk.options.model)) {
    study::Versions versions(desk.options.model);
    if (versions.current()) return versions;
  }
  throw NotFoundError(Problem{.what = "no versions of a model",
                              .where = desk.options.model.string(),
                              .expected = "a study",
                              .advice = "elrom-serve --model STUDY"});
}

Json verdict_of(const study::VersionEvent& event) {
  return event.verdict.empty() ? Json() : Json::parse(event.verdict);
}

Json document_of(const study::Versions& versions, int number) {
  Json document{{"number", number}, {"answers", versions.current() == number}};
  const auto* event = versions.last_of(number);
  if (event == nullptr) return document;
  document["by"] = event->by;
  document["promoted"] = event->promoted;
  document["parent"] = event->parent ? Json(*event->parent) : Json();
  document["date"] = event->date.empty() ? Json() : Json(event->date);
  document["cases"] = event->n_cases;
  document["digest"] = event->digest;
  document["verdict"] = verdict_of(*event);
  return document;
}

http::Response list_versions(Desk& desk, const Ask& /*ask*/) {
  const auto versions = versions_of(desk);
  Json items = Json::array();
  for (const int number : versions.numbers()) items.push_back(document_of(versions, number));
  return json_response({{"items", items}});
}

std::filesystem::path file_of(const study::Versions& versions, repository::Id number) {
  const auto numbers = versions.numbers();
  if (std::ranges::find(numbers, number) != numbers.end()) return versions.file(static_cast<int>(number));
  std::vector<std::string> known;
  for (const int one : numbers) known.push_back(std::to_string(one));
  throw NotFoundError(Problem{
      .what = "no such version", .found = std::to_string(number), .expected = base::join(known, ", ")});
}

http::Response one_version(Desk& desk, const Ask& ask) {
  const auto versions = versions_of(desk);
  const auto number = id_of(ask);
  const model::BundleReader bundle(file_of(versions, number));
  auto document = document_of(versions, static_cast<int>(number));
  const auto& info = bundle.info();
  document["program"] = bundle.file().text("program");
  document["method"] = info.method;
  document["provenance"] = info.provenance;
  document["settings"] = info.settings;
  document["accuracy"] = Json::parse(info.accuracy_json);
  return json_response(document);
}

http::Response promote(Desk& desk, const Ask& ask) {
  const JsonBody body(ask.request.body, {"number"});
  const auto number = body.whole("number");
  const auto versions = versions_of(desk);
  try {
    (void)file_of(versions, number);
  } catch (const NotFoundError& error) {
    throw InputError(error.problem());  // it is the request that names what is not there
  }
  try {
    study::promote(desk.options.model, static_cast<int>(number));
  } catch (const UsageError& error) {
    throw repository::ConflictError(error.problem());  // a training holds the study
  }
  desk.model.look();
  return json_response(document_of(versions_of(desk), static_cast<int>(number)));
}

http::Response make_report(Desk& desk, const Ask& ask) {
  const auto versions = versions_of(desk);
  const auto number = id_of(ask);
  (void)file_of(versions, number);
  const auto file = desk.reports.of(desk.options.model, versions, static_cast<int>(number));
  const auto place = "/reports/" + desk.reports.places.open(file);
  auto response = json_response({{"place", place}}, 201);
  response.headers.emplace_back("Location", place);
  return response;
}

/// A document with scripts of its own, in a policy of its own: it has no origin (so it sees neither our page
/// nor its token), reaches no server, and runs what stands in it as a script and nothing else.
http::Response report(Desk& desk, const Ask& ask) {
  const auto file = desk.reports.places.file(ask.parameters[0]);
  if (!file) throw NotFoundError(Problem{.what = "no report here", .advice = "open it again from the page"});
  const auto nonce = repository::random_secret();
  const std::string script = "<script>";
  auto text = base::read_text(*file);
  for (auto at = text.find(script); at != std::string::npos; at = text.find(script, at + 1))
    text.insert(at + script.size() - 1, " nonce=\"" + nonce + "\"");
  return {.headers = {{"Content-Type", "text/html; charset=utf-8"},
                      {"Content-Security-Policy",
                       "sandbox allow-scripts; default-src 'none'; script-src 'nonce-" + nonce +
                           "'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action "
                           "'none'; frame-ancestors 'none'"},
                      {"Referrer-Policy", "no-referrer"},
                      {"Cache-Control", "no-store"}},
          .body = std::move(text)};
}

}  // namespace

std::vector<Route> version_routes() {
  return {{.method = "GET",
           .path = "/models",
           .role = Role::reader,
           .summary = "Versions of the study's model: what made each, and what the gate said",
           .answers = {{200, "all of them"}, {404, "it is no study's model that answers"}},
           .answer = list_versions},
          {.method = "GET",
           .path = "/models/{id}",
           .role = Role::reader,
           .summary = "One version: its errors, settings and origin",
           .answers = {{200, "it"}},
           .answer = one_version},
          {.method = "POST",
           .path = "/models/{id}/report",
           .role = Role::reader,
           .summary =
               "A place where a browser may open the version's report for ten minutes: its accuracy or, of "
               "one that does not answer, how it compares with the one that does. Made when it is first "
               "asked for",
           .answers = {{201, "it is at `place`"}, {409, "a report is being made"}},
           .answer = make_report},
          {.method = "GET",
           .path = "/reports/{place}",
           .role = {},
           .summary = "A report: one HTML document with its own scripts, in a sandbox",
           .answers = {{200, "it"}, {404, "there is no such place, or no longer"}},
           .answer = report,
           .media = {"text/html"}},
          {.method = "PUT",
           .path = "/models/current",
           .role = Role::admin,
           .summary = "Makes a version answer, whatever the gate said",
           .answers = {{200, "it answers"},
                       {404, "it is no study's model that answers"},
                       {409, "a training is at work in the study"}},
           .answer = promote,
           .body = BodyKind::json,
           .example = R"({"number": 1})",
           .wrong = R"({"number": 999999})",
           .required = {"number"}}};
}

}  // namespace elrom::serve
